"""The live viewer: a server on this machine that a browser shows."""

from __future__ import annotations

import contextlib
import io
import threading
import time
from collections.abc import Iterator

import numpy as np
import viser

from mmplan.exceptions import MmplanError
from mmplan.visualization.camera import FIELD_OF_VIEW, best_camera
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.viewer.player import Player
from mmplan.visualization.viewer.stage import Stage

# The server is for this machine alone.
HOST = "127.0.0.1"
_STEP = 1.0 / 30.0  # s


class _ClosedError(Exception):
    """Raised in the background when nobody waits for its results any more."""


class Viewer:
    """An exhibit on a server of its own.

    The motion can be looked at once this is made. Clearances and the optimizer's
    candidates take seconds to compute, and join when they are there.
    """

    def __init__(self, exhibit: Exhibit, port: int) -> None:
        """Start the server at a port, or at the next one that is free."""
        self._exhibit = exhibit
        self._closed = threading.Event()
        with _silence():
            self._server = viser.ViserServer(
                host=HOST, port=port, label=f"mmplan: {exhibit.title}", verbose=False
            )
        self._set_up()
        self._stage = Stage(self._server.scene, "/scene", exhibit.parts)
        self._add_layers()
        self._player: Player | None = None
        if exhibit.plan is not None:
            self._player = Player(self._server, self._stage, exhibit.film)
        else:
            self._stage.place({n: T[0] for n, T in exhibit.film.poses.items()})
        self._background = threading.Thread(target=self._compute, daemon=True)
        self._background.start()

    @property
    def url(self) -> str:
        """Where a browser finds it."""
        return f"http://{HOST}:{self._server.get_port()}"

    def run(self) -> None:
        """Play until the process is interrupted."""
        before = time.monotonic()
        while True:
            time.sleep(_STEP)
            now = time.monotonic()
            if self._player is not None:
                self._player.tick(now - before)
            before = now

    def close(self) -> None:
        """Stop the server and whatever is computed in the background."""
        self._closed.set()
        self._background.join()
        with _silence():
            self._server.stop()

    def _set_up(self) -> None:
        """Camera, light and panel."""
        server, camera = self._server, best_camera(self._exhibit)
        server.scene.set_up_direction("+z")
        # Shadows cost more than all else where the browser has no GPU.
        server.scene.configure_default_lights(cast_shadow=False)
        server.initial_camera.position = camera.eye
        server.initial_camera.look_at = camera.target
        server.initial_camera.fov = float(np.radians(FIELD_OF_VIEW))
        server.gui.configure_theme(
            control_layout="collapsible", show_logo=False, show_share_button=False
        )
        server.gui.set_panel_label(f"{self._exhibit.title} – mmplan")
        server.gui.add_markdown(self._exhibit.subtitle)

    def _add_layers(self) -> None:
        with self._server.gui.add_folder("Shown", expand_by_default=False):
            for layer in self._stage.layers:
                self._add_layer(layer)
            shadows = self._server.gui.add_checkbox("shadows", False)
        shadows.on_update(
            lambda _: self._server.scene.configure_default_lights(
                cast_shadow=shadows.value
            )
        )

    def _add_layer(self, layer: str) -> None:
        box = self._server.gui.add_checkbox(layer, True)
        box.on_update(lambda _: self._stage.show(layer, visible=box.value))

    def _compute(self) -> None:
        """Add what takes time, unless the viewer is closed first."""
        # These import the planner and the optimizers, which take time as well.
        from mmplan.visualization.clearance import clearance_curve
        from mmplan.visualization.search import searches
        from mmplan.visualization.viewer import candidates

        exhibit = self._exhibit
        if exhibit.plan is None or self._player is None:
            return
        problem, plan = exhibit.problem, exhibit.plan
        waiting = self._server.gui.add_markdown("*computing clearances and candidates*")
        try:
            curve = clearance_curve(problem, plan, exhibit.film, self._stop_if_closed)
            self._player.add_clearance(curve)
            found = list(searches(problem, plan, lambda _: self._stop_if_closed()))
            candidates.CandidatePanel(self._server, exhibit, found)
            candidates.PopulationPanel(self._server, found)
            # Removed, it would be missed by a browser that connects in this moment.
            waiting.visible = False
        except _ClosedError:
            return
        except MmplanError as error:  # a scene whose optimizer does not run here
            waiting.content = f"no candidates: {error}"

    def _stop_if_closed(self) -> None:
        if self._closed.is_set():
            raise _ClosedError


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep what viser has to say from the terminal."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
