"""Models of MuJoCo as obstacles: what collides, where it is at the start."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.imports.foreign_scene import (
    ForeignScene,
    ForeignThing,
    Triangles,
    only_file,
)
from mmplan.mujoco_library import load_mujoco
from mmplan.shapes import Array

_FLOOR = 20.0  # m, edge of the box that a plane without an end becomes
_THICKNESS = 0.1  # m, of that box


def read_mjcf(files: Sequence[Path]) -> ForeignScene:
    """Every geom that can collide becomes an obstacle; joints are at their start.

    Raises:
        InputError: There is more than one file, MuJoCo cannot read it, or MuJoCo is
            not installed.
    """
    mujoco = load_mujoco("models of MuJoCo")
    path = only_file(files, "a model of MuJoCo")
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, OSError) as error:
        raise InputError(f"{path}: {error}") from None
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    scene = ForeignScene(path.stem)
    for geom in range(model.ngeom):
        if model.geom_contype[geom] or model.geom_conaffinity[geom]:
            _add(mujoco, model, data, geom, scene)
    if model.njnt:
        text = f"{path.name}: {model.njnt} joints, held where they start"
        scene.unsupported.append(text)
    return scene


def _add(
    mujoco: ModuleType, model: Any, data: Any, geom: int, scene: ForeignScene
) -> None:
    T = np.eye(4)
    T[:3, :3] = data.geom_xmat[geom].reshape(3, 3)
    T[:3, 3] = data.geom_xpos[geom]
    name = _name(model, geom)
    kind = mujoco.mjtGeom(int(model.geom_type[geom]))
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        _add_plane(model.geom_size[geom], T, name, scene)
        return
    shape = _shape(mujoco, model, geom, kind)
    if shape is None:
        label = kind.name.removeprefix("mjGEOM_").lower()
        scene.unsupported.append(f"{name}: a geom of type {label}")
        return
    scene.add(name, [(shape, T)])


def _name(model: Any, geom: int) -> str:
    """The body's name if the geom is its only one, else the geom's own."""
    body = int(model.geom_bodyid[geom])
    named, own = model.body(body).name, model.geom(geom).name
    if body and named and model.body_geomnum[body] == 1:
        return str(named)
    return str(own or f"{named or 'geom'}_{geom}")


def _shape(
    mujoco: ModuleType, model: Any, geom: int, kind: Any
) -> dict[str, Any] | Triangles | None:
    x, y, z = (float(v) for v in model.geom_size[geom])
    types = mujoco.mjtGeom
    if kind == types.mjGEOM_BOX:
        return {"box": [2 * x, 2 * y, 2 * z]}
    if kind == types.mjGEOM_SPHERE:
        return {"sphere": {"radius": x}}
    if kind == types.mjGEOM_CYLINDER:
        return {"cylinder": {"radius": x, "length": 2 * y}}
    if kind == types.mjGEOM_CAPSULE:
        return {"capsule": {"radius": x, "length": 2 * y}}
    if kind == types.mjGEOM_MESH:
        return _mesh(model, int(model.geom_dataid[geom]))
    return None


def _mesh(model: Any, mesh: int) -> Triangles:
    """The triangles of a mesh, which MuJoCo has moved to its centre as it has T."""
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    vertices = np.array(model.mesh_vert[first : first + count], dtype=np.float64)
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return Triangles(vertices, model.mesh_face[first : first + count].tolist())


def _add_plane(size: Array, T: Array, name: str, scene: ForeignScene) -> None:
    """A level plane becomes a box that the base drives on; others are named."""
    if T[2, 2] < 1.0 - 1e-9:
        scene.unsupported.append(f"{name}: a plane that is not level")
        return
    x, y = (2 * float(s) if s > 0.0 else _FLOOR for s in size[:2])
    T = T.copy()
    T[2, 3] -= _THICKNESS / 2
    scene.things.append(ForeignThing(name, {"box": [x, y, _THICKNESS]}, T, ground=True))
