"""Parts as nodes of viser's scene, below the nodes of their carriers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import viser
from viser import MeshHandle, SceneApi

from mmplan.shapes import Array
from mmplan.visualization.part import WORLD, Colour, Part
from mmplan.visualization.rotations import pose_numbers


class Stage:
    """Parts that stand or move; `root` is where their nodes are, such as `/scene`."""

    def __init__(self, scene: SceneApi, root: str, parts: Iterable[Part]) -> None:
        """Add the parts to the scene."""
        self._scene = scene
        self._root = root
        self._carriers: dict[str, viser.FrameHandle] = {}
        self._layers: dict[str, list[MeshHandle]] = {}
        for number, part in enumerate(parts):
            self._add(number, part)

    @property
    def layers(self) -> tuple[str, ...]:
        """The layers that parts are on."""
        return tuple(self._layers)

    def show(self, layer: str, *, visible: bool) -> None:
        """Show or hide a layer."""
        for mesh in self._layers[layer]:
            mesh.visible = visible

    def show_all(self, *, visible: bool) -> None:
        """Show or hide everything."""
        for layer in self._layers:
            self.show(layer, visible=visible)

    def place(self, poses: Mapping[str, Array]) -> None:
        """Put carriers at poses T_world_carrier (4, 4); those not named stay."""
        for name, frame in self._carriers.items():
            if name in poses:
                x, y, z, qx, qy, qz, qw = pose_numbers(poses[name][None])[0].tolist()
                frame.position = (x, y, z)
                frame.wxyz = (qw, qx, qy, qz)

    def _add(self, number: int, part: Part) -> None:
        if len(part.surface.triangles) == 0:
            return
        mesh = self._scene.add_mesh_simple(
            f"{self._node(part.carrier)}/{number} {_without_slashes(part.name)}",
            part.surface.vertices.astype(np.float32),
            part.surface.triangles.astype(np.uint32),
            color=rgb(part.colour),
            opacity=part.colour.opacity if part.colour.opacity < 1.0 else None,
            side="double",
            cast_shadow=part.colour.opacity == 1.0,
        )
        self._layers.setdefault(part.layer, []).append(mesh)

    def _node(self, carrier: str) -> str:
        if carrier == WORLD:
            return self._root
        node = f"{self._root}/{_without_slashes(carrier)}"
        if carrier not in self._carriers:
            self._carriers[carrier] = self._scene.add_frame(node, show_axes=False)
        return node


def rgb(colour: Colour) -> tuple[int, int, int]:
    """A colour without its opacity, from 0 to 255."""
    red, green, blue = (round(255.0 * value) for value in colour[:3])
    return red, green, blue


def _without_slashes(name: str) -> str:
    """A name that is one node's, as slashes part the names of nodes."""
    return name.replace("/", " ")
