"""The time line: play, speed, segments, and the clearance along time."""

from __future__ import annotations

import numpy as np
from viser import GuiEvent, GuiSliderHandle, GuiUplotHandle, ViserServer, uplot

from mmplan.visualization.clearance import ClearanceCurve
from mmplan.visualization.film import Film
from mmplan.visualization.viewer.stage import Stage
from mmplan.visualization.viewer.widgets import set_value

_SPEEDS = {"¼": 0.25, "½": 0.5, "1": 1.0, "2": 2.0}
# Segments shorter than this share of the motion have a mark without a name.
_NAMED = 0.12
# The mark of the present moment in the plot moves this seldom, s of wall time.
_PLOT_STEP = 0.25


class Player:
    """Plays a film on a stage; its clock is moved by `tick`."""

    def __init__(self, server: ViserServer, stage: Stage, film: Film) -> None:
        """Add the widgets of the time line."""
        self._server = server
        self._stage = stage
        self._film = film
        self._speed = 1.0
        self._playing = False
        self._time = 0.0
        self._clearance: ClearanceCurve | None = None
        self._plot: GuiUplotHandle | None = None
        self._since_plot = 0.0
        self._folder = server.gui.add_folder("Motion")
        with self._folder:
            self._button = server.gui.add_button("Play")
            speed = server.gui.add_button_group("speed", list(_SPEEDS))
            self._slider = self._add_slider()
            names = [f"{i + 1} {mark.name}" for i, mark in enumerate(film.marks)]
            jump = server.gui.add_dropdown("segment", names)
            self._text = server.gui.add_markdown("")
        self._button.on_click(lambda _: self._toggle())
        self._slider.on_update(self._dragged)
        speed.on_click(lambda _: self._set_speed(speed.value))
        jump.on_update(lambda _: self._jump(names.index(jump.value)))
        self.show(0.0)

    def tick(self, seconds: float) -> None:
        """Let that much wall time pass."""
        self._since_plot += seconds
        if self._playing:
            time = self._time + seconds * self._speed
            if time >= self._film.duration:
                self._toggle()
            self.show(min(time, self._film.duration))
            set_value(self._slider, round(self._time, 2))

    def show(self, time: float) -> None:
        """Show the moment at a time (s)."""
        self._time = time
        frame = self._film.frame_at(time)
        with self._server.atomic():
            self._stage.place({n: T[frame] for n, T in self._film.poses.items()})
        self._tell()

    def add_clearance(self, curve: ClearanceCurve) -> None:
        """Show the clearance along time from now on."""
        self._clearance = curve
        with self._folder:
            self._plot = self._server.gui.add_uplot(
                self._plotted(),
                (
                    uplot.Series(label="s"),
                    uplot.Series(label="clearance, mm", stroke="#2f6fd0", width=2),
                    uplot.Series(
                        label="now", stroke="#c03020", points={"show": True, "size": 9}
                    ),
                ),
                scales={"x": uplot.Scale(time=False)},
                aspect=2.2,
            )
        self._tell()

    def _add_slider(self) -> GuiSliderHandle[float]:
        film = self._film
        marks = tuple(
            (m.start, m.name if m.end - m.start > _NAMED * film.duration else "")
            for m in film.marks
        )
        end = max(round(film.duration, 2), 0.01)
        return self._server.gui.add_slider("time, s", 0.0, end, 0.01, 0.0, marks=marks)

    def _toggle(self) -> None:
        self._playing = not self._playing
        self._button.label = "Pause" if self._playing else "Play"
        if self._playing and self._time >= self._film.duration:
            self._time = 0.0

    def _dragged(self, event: GuiEvent[GuiSliderHandle[float]]) -> None:
        if event.client is not None:  # by a person, not by the clock
            self.show(float(self._slider.value))

    def _set_speed(self, name: str) -> None:
        self._speed = _SPEEDS[name]

    def _jump(self, number: int) -> None:
        self.show(self._film.marks[number].start)
        set_value(self._slider, round(self._time, 2))

    def _tell(self) -> None:
        mark = self._film.mark_at(self._time)
        text = f"**{mark.name}** ({mark.object})" if mark else ""
        if curve := self._clearance:
            k = int(np.argmin(np.abs(curve.times - self._time)))
            names = " / ".join(curve.pairs[k])
            text += f"; clearance {1000.0 * curve.distances[k]:.1f} mm: {names}"
        if self._text.content != text:
            self._text.content = text
        if self._plot is not None and self._since_plot >= _PLOT_STEP:
            self._since_plot = 0.0
            self._plot.data = self._plotted()

    def _plotted(self) -> tuple[np.ndarray, ...]:
        """Times, clearances (mm), and the clearance of the present moment alone."""
        assert self._clearance is not None
        curve = self._clearance
        now = np.full(len(curve.times), np.nan)
        k = int(np.argmin(np.abs(curve.times - self._time)))
        now[k] = 1000.0 * curve.distances[k]
        return curve.times, 1000.0 * curve.distances, now
