"""Pictures of parts, drawn by MuJoCo without a window or a GPU."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from types import ModuleType, TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from mmplan.exceptions import InputError
from mmplan.mujoco_library import load_mujoco
from mmplan.shapes import Array
from mmplan.visualization.camera import FIELD_OF_VIEW, Camera
from mmplan.visualization.part import WORLD, Part

Image = npt.NDArray[np.uint8]  # (height, width, 3)

_MISSING_GL = (
    "there is no software OpenGL to draw pictures with. Install Mesa's, on Debian "
    "'apt-get install libegl1 libgl1-mesa-dri' or 'apt-get install libosmesa6', or "
    "render an HTML page, which needs none"
)
# Pictures have shadows this sharp, and edges this smooth.
_SHADOWS, _SAMPLES = 2048, 4


class Studio:
    """Parts lit and ready to be drawn again and again as their carriers move."""

    def __init__(
        self,
        parts: Sequence[Part],
        size: tuple[int, int],
        camera: Camera,
        sun: Camera,
    ) -> None:
        """Prepare for pictures of a size: width and height in pixels.

        The light shines from where `sun` is, as `camera` looks.

        Raises:
            InputError: MuJoCo is not installed, or there is no OpenGL.
        """
        self._mujoco = mujoco = _mujoco()
        width, height = size
        spec, self._bodies = _model(mujoco, parts, size, sun)
        self._view = _view(mujoco, camera)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        try:
            self._renderer = mujoco.Renderer(self._model, height, width)
        except (AttributeError, ImportError, RuntimeError, mujoco.FatalError) as error:
            reason = str(error).strip().partition("\n")[0]
            raise InputError(f"{_MISSING_GL} ({reason})") from error

    def __enter__(self) -> Studio:
        """Hold the OpenGL context until the block ends."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Give the OpenGL context back."""
        self._renderer.close()

    def picture(self, poses: Mapping[str, Array]) -> Image:
        """A picture of the parts, their carriers at poses T_world_carrier (4, 4)."""
        for carrier, place in self._bodies.items():
            T = poses[carrier]
            self._data.mocap_pos[place] = T[:3, 3]
            quat = np.zeros(4)
            self._mujoco.mju_mat2Quat(quat, np.ascontiguousarray(T[:3, :3]).ravel())
            self._data.mocap_quat[place] = quat
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_camlight(self._model, self._data)
        self._renderer.update_scene(self._data, self._view)
        image: Image = self._renderer.render()
        return image.copy()


def _mujoco() -> ModuleType:
    """MuJoCo, ready to draw.

    Raises:
        InputError: It is not installed, or there is no library to draw with.
    """
    mujoco = load_mujoco("pictures")
    if not os.environ.get("MUJOCO_GL"):
        raise InputError(_MISSING_GL)
    return mujoco


def _view(mujoco: ModuleType, camera: Camera) -> Any:
    view = mujoco.MjvCamera()
    view.lookat = camera.target
    view.distance = camera.distance
    # MuJoCo's angles are those of the direction in which the camera looks.
    view.azimuth = camera.azimuth + 180.0
    view.elevation = -camera.elevation
    return view


def _model(
    mujoco: ModuleType, parts: Sequence[Part], size: tuple[int, int], sun: Camera
) -> tuple[Any, dict[str, int]]:
    """MuJoCo's model of the parts, and which mocap body stands for which carrier."""
    spec = mujoco.MjSpec()
    _set_the_stage(mujoco, spec, size)
    _add_light(mujoco, spec, sun)
    bodies: dict[str, Any] = {WORLD: spec.worldbody}
    for number, part in enumerate(parts):
        if len(part.surface.triangles) == 0:
            continue
        if part.carrier not in bodies:
            bodies[part.carrier] = spec.worldbody.add_body(
                name=part.carrier, mocap=True
            )
        _add(mujoco, spec, bodies[part.carrier], f"{number} {part.name}", part)
    carriers = [carrier for carrier in bodies if carrier != WORLD]
    return spec, {carrier: place for place, carrier in enumerate(carriers)}


def _set_the_stage(mujoco: ModuleType, spec: Any, size: tuple[int, int]) -> None:
    """Light, background and quality."""
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = size
    visual.global_.fovy = FIELD_OF_VIEW
    visual.quality.shadowsize, visual.quality.offsamples = _SHADOWS, _SAMPLES
    visual.headlight.ambient = [0.42] * 3
    visual.headlight.diffuse = [0.3] * 3
    visual.headlight.specular = [0.05] * 3
    visual.map.znear, visual.map.zfar = 0.01, 50.0
    visual.map.shadowclip = 1.5  # times the extent: as far as floors reach
    spec.stat.extent, spec.stat.center = 3.0, [0.0, 0.0, 0.8]
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.97, 0.98, 1.0],
        rgb2=[0.8, 0.84, 0.9],
        width=64,
        height=64,
    )


def _add_light(mujoco: ModuleType, spec: Any, sun: Camera) -> None:
    """A light whose rays are parallel."""
    spec.worldbody.add_light(
        pos=sun.eye,
        dir=sun.target - sun.eye,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        diffuse=[0.45] * 3,
        specular=[0.1] * 3,
        castshadow=True,
    )


def _add(mujoco: ModuleType, spec: Any, body: Any, name: str, part: Part) -> None:
    surface = part.surface
    spec.add_mesh(
        name=name,
        uservert=surface.vertices.ravel(),
        userface=surface.triangles.ravel().astype(np.int32),
        usernormal=surface.normals.ravel(),
        userfacenormal=surface.triangles.ravel().astype(np.int32),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        rgba=list(part.colour),
        contype=0,
        conaffinity=0,
    )
