"""The controls of the viewer. Their callbacks run in threads of viser, and do nothing but say what was touched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.viewing.arrow_shapes import rung
from rttrr_pin.viewing.canvas import COLOURS, THINGS, Shown
from rttrr_pin.viewing.recording import Recording
from rttrr_pin.viewing.states import Slider, State, displacement, slider, sliders

if TYPE_CHECKING:
    import viser

Touched = tuple[str, int]
"""Which control, and which of its kind."""

TITLES = {"q": "Coordinates q", "v": "Rates v", "a": "Accelerations a"}

SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")

OPENED = 12
"""Degrees of freedom up to which the sliders of q are unfolded."""

WRENCH = ("fx", "fy", "fz", "nx", "ny", "nz")

MOMENT = 20.0
"""Largest moment of a slider of the payload [N m]."""


@dataclass(frozen=True, slots=True)
class Contents:
    """What a panel is made for.

    Attributes:
        model: the robot.
        programs: what arrows can be of.
        recording: what can be played.
        things: what is shown at first.
        opacity: of the bodies at first.
        weight: of the robot [N], by which sliders of forces go.
    """

    model: Model
    programs: tuple[str, ...]
    recording: Recording | None
    things: frozenset[str]
    opacity: float
    weight: float


class Panel:
    """Controls on the right, numbers on the left."""

    def __init__(self, server: viser.ViserServer, contents: Contents) -> None:
        self.contents, self.model = contents, contents.model
        self.touched: SimpleQueue[Touched] = SimpleQueue()
        self.gui = server.gui
        self.sliders = sliders(self.model)
        numbers = self.gui.add_panel()
        with numbers.add_tab("Numbers"):
            self.numbers = self.gui.add_html("")
            self._add_link()
            self.link_numbers = self.gui.add_html("")
        numbers.dock_left()
        numbers.set_width(460)
        self.gui.main_panel.dock_right()
        tabs = self.gui.add_tab_group()
        with tabs.add_tab("Motion"):
            if contents.recording is not None:
                self._add_playing(contents.recording)
            self._add_state()
            self._add_payload()
        with tabs.add_tab("Show"):
            self._add_showing()

    def _watch(self, handle: Any, name: str, k: int = 0) -> Any:
        """Say that a person touched a control; what is set from here is not said."""

        def said(event: Any) -> None:
            if event.client_id is not None:
                self.touched.put((name, k))

        (handle.on_click if hasattr(handle, "on_click") else handle.on_update)(said)
        return handle

    def _add_link(self) -> None:
        self._links = _distinct(self.model.link_names)
        options = self._links or ("(no link moves)",)
        massive = [i for i, link in enumerate(self.model.links) if link.mass] or [0]
        choice = self.gui.add_dropdown("link", options, initial_value=options[massive[0]])
        self.link_choice = self._watch(choice, "show")

    def _add_playing(self, recording: Recording) -> None:
        self.playing = False
        with self.gui.add_folder("Trajectory"):
            if recording.rows.time is not None:
                self.play = self._watch(self.gui.add_button("Play"), "play")
                speed = self.gui.add_dropdown("speed", SPEEDS, initial_value="1")
                self.speed = self._watch(speed, "speed")
            last = len(recording.rows) - 1
            self.row = self._watch(self.gui.add_slider(recording.counted, 0, max(last, 1), 1, 0), "row")
            self._watch(self.gui.add_button("Worst state"), "worst")
            self.place = self.gui.add_html("")

    def _add_showing(self) -> None:
        if len(self.contents.programs) > 1:
            choice = self.gui.add_dropdown(
                "arrows of", self.contents.programs, initial_value=self.contents.programs[-1]
            )
            self.program = self._watch(choice, "program")
        self.longer = self._watch(
            self.gui.add_slider("arrow length", -9, 9, 1, 0, hint="one step is a factor of 2 or 2.5"), "show"
        )
        self.scale = self.gui.add_html("")
        self._watch(self.gui.add_button("Fit arrows"), "fit")
        self.shown = {
            thing: self._watch(self.gui.add_checkbox(thing, thing in self.contents.things), "show")
            for thing in THINGS
            if thing != "bodies" or self.contents.opacity > 0.0
        }
        labels = ("chosen link", "all links", "none")
        self.labels = self._watch(self.gui.add_dropdown("labels at", labels), "show")
        if self.contents.opacity > 0.0:
            opacity = self.gui.add_slider("opacity of bodies", 0.1, 1.0, 0.05, self.contents.opacity)
            self.opacity = self._watch(opacity, "show")

    def _add_state(self) -> None:
        self._watch(self.gui.add_button("All zero"), "zero")
        self._watch(self.gui.add_button("At rest: v = a = 0"), "rest")
        self._handles: dict[str, list[Any]] = {}
        for name, title in TITLES.items():
            unfolded = name == "q" and self.model.nv <= OPENED
            with self.gui.add_folder(title, expand_by_default=unfolded):
                self._handles[name] = [
                    self._watch(self._slider(own), name, k) for k, own in enumerate(self.sliders[name])
                ]

    def _slider(self, own: Slider) -> Any:
        if not own.high > own.low:
            return self.gui.add_slider(_short(own), own.low, own.low + 1.0, 1.0, own.low, disabled=True)
        return self.gui.add_slider(_short(own), own.low, own.high, own.step, own.shown(0.0))

    def _add_payload(self) -> None:
        if not self.model.links:
            return
        most = max(50.0, float(f"{self.contents.weight:.1g}"))
        with self.gui.add_folder("Payload: what the robot exerts", expand_by_default=False):
            leaf = self.model.leaves()[-1]
            self.payload_link = self._watch(
                self.gui.add_dropdown("at link", self._links, initial_value=self._links[leaf]), "payload"
            )
            self.payload_axes = self._watch(self.gui.add_dropdown("in axes of", ("base", "link")), "payload")
            self.payload = [
                self._watch(self._slider(slider(name, "N" if k < 3 else "N m", -end, end)), "payload")
                for k, (name, end) in enumerate(zip(WRENCH, [most] * 3 + [MOMENT] * 3, strict=True))
            ]

    @property
    def link(self) -> int:
        """The chosen link."""
        return self._links.index(self.link_choice.value) if self._links else 0

    def load(self) -> tuple[Load, ...]:
        """The payload that the sliders say; none where all are zero."""
        if not self.model.links:
            return ()
        wrench = np.array([handle.value for handle in self.payload], dtype=np.float64)
        link = self._links.index(self.payload_link.value)
        in_base = self.payload_axes.value == "base"
        return (Load(link, wrench[:3], wrench[3:], in_base),) if wrench.any() else ()

    def value(self, name: str, k: int) -> float:
        """What a slider of q, v or a is at."""
        return float(self._handles[name][k].value)

    def look(self, forces: int, moments: int) -> Shown:
        """What is to be drawn; the rungs of the scales are those that fit."""
        things = frozenset(thing for thing, handle in self.shown.items() if handle.value)
        longer = round(self.longer.value)
        opacity = float(self.opacity.value) if self.contents.opacity > 0.0 else 1.0
        return Shown(things, self.labels.value, self.link, opacity, rung(forces - longer), rung(moments - longer))

    def follow(self, state: State) -> None:
        """Put the sliders where a state is; those that it is beyond stand at their end."""
        numbers = {"q": displacement(self.model, state.q), "v": state.v, "a": state.a}
        for name, own in numbers.items():
            for handle, limits, value in zip(self._handles[name], self.sliders[name], own, strict=True):
                if not handle.disabled:
                    handle.value = limits.shown(float(value))

    def follow_row(self, k: int, words: str) -> None:
        """Say which row is shown."""
        self.row.value = k
        self.place.content = words

    def show_playing(self, playing: bool) -> None:
        """The button says what it would do."""
        self.play.label = "Pause" if playing else "Play"


def _short(own: Slider) -> str:
    return f"{own.label} [{own.unit}]"


def _distinct(names: Sequence[str]) -> tuple[str, ...]:
    """Names as they can be chosen from: not empty."""
    return tuple(name or "(no name)" for name in names)


def legend() -> str:
    """The colours of the arrows."""
    lines = (
        (("f", "n"), "by the parent, at the joint"),
        (("F", "N"), "net, at the centre of mass"),
        (("payload f", "payload n"), "what the robot exerts"),
    )
    swatch = '<i style="background:rgb{}"></i>{}'
    return "<br>".join("".join(swatch.format(COLOURS[key], key) for key in keys) + f": {said}" for keys, said in lines)
