"""The viewer: one thread takes what was touched, computes, and draws, so that no error is lost in another."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from queue import Empty

import numpy as np

from rttrr_pin.errors import RttrrError
from rttrr_pin.viewing.arrow_shapes import fitting
from rttrr_pin.viewing.canvas import Canvas, Shown
from rttrr_pin.viewing.evaluation import Evaluator, Numbers
from rttrr_pin.viewing.looks import Looks
from rttrr_pin.viewing.numbers import STYLE, joint_table, link_table, quantities_missing, state_in_python, text
from rttrr_pin.viewing.panel import Contents, Panel, legend
from rttrr_pin.viewing.recording import Recording
from rttrr_pin.viewing.scene import MOMENTS, PAYLOAD, Arrows, arrows, placement, reach
from rttrr_pin.viewing.server import address, close, open_server
from rttrr_pin.viewing.states import State, at_rest, moved

FRAME = 1 / 25
"""Seconds from picture to picture while it plays."""

FOLLOWING = 0.3
"""Seconds after which the sliders follow what is played; they are many."""


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """What is viewed.

    Attributes:
        evaluator: computes the numbers.
        looks: what the robot looks like.
        recording: what can be played; None where there is nothing.
        start: the first state; None is at rest, or the first row.
        notes: what a viewer should know.
    """

    evaluator: Evaluator
    looks: Looks
    recording: Recording | None = None
    start: State | None = None
    notes: tuple[str, ...] = ()


class Viewer:
    """A robot in the browser.

    Attributes:
        state: what is shown.
        row: which row of the recording; -1 where it is none.
        numbers: what the programs say of the state; None where one refuses.
        error: why.
    """

    def __init__(self, subject: Subject, port: int = 0) -> None:
        """Serve on a port of this machine; 0 is any that is free.

        Raises:
            InputError: viser is not installed, or the port is not to be had.
        """
        self.subject, self.evaluator = subject, subject.evaluator
        model, recording = self.evaluator.model, subject.recording
        self.model = model
        self.state, self.row = subject.start or at_rest(model), -1
        if subject.start is None and recording is not None:
            self.state, self.row = recording.rows.state(0), 0
        self.numbers: Numbers | None = None
        self.error = ""
        self._playing_since: float | None = None
        self._followed = 0.0
        where = placement(model, self.state.q)
        self.reach = max(reach(model, own) for own in (where, placement(model, at_rest(model).q)))
        self.server = open_server(port, text(model.name))
        try:
            self.canvas = Canvas(self.server, model, subject.looks, where, self.reach)
            self.panel = Panel(self.server, self._contents())
            self._fit()
            self.panel.follow(self.state)
            self.show()
        except BaseException:
            close(self.server)
            raise

    def _contents(self) -> Contents:
        bodies = {"bodies"} if self.canvas.has_bodies else set()
        skeleton = {"skeleton"} if self.subject.looks.missing or not bodies else set()
        things = frozenset({"f", "n", "centres of mass"} | bodies | skeleton)
        weight = 9.81 * sum(abs(link.mass) for link in self.model.links)
        opacity = 0.4 if self.canvas.has_bodies else 0.0
        return Contents(self.model, self.evaluator.names, self.subject.recording, things, opacity, min(weight, 1e6))

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return address(self.server)

    def close(self) -> None:
        """Serve no more; `run` returns."""
        self.panel.touched.put(("close", 0))
        close(self.server)

    def run(self) -> None:
        """Do what is asked for until `close`, or until a signal."""
        try:
            while True:
                touched = self._waited()
                if ("close", 0) in touched:
                    return
                for name, k in touched:
                    self._done(name, k)
                if self._playing_since is not None:
                    self._play_on()
                self.show()
        finally:
            close(self.server)

    def _waited(self) -> list[tuple[str, int]]:
        """What was touched since, each control once; while it plays, perhaps nothing."""
        touched: dict[tuple[str, int], None] = {}
        with_frames = self._playing_since is not None
        try:
            touched[self.panel.touched.get(timeout=FRAME if with_frames else None)] = None
            while True:
                touched[self.panel.touched.get_nowait()] = None
        except Empty:
            return list(touched)

    def _done(self, name: str, k: int) -> None:
        """What a control asks for."""
        if name in ("q", "v", "a"):
            self._stop()
            self.state, self.row = moved(self.model, self.state, name, k, self.panel.value(name, k)), -1
            return
        asked: dict[str, Callable[[], None]] = {
            "play": self._play, "row": self._scrub, "worst": self.jump_to_worst, "speed": self._change_speed,
            "zero": lambda: self.jump(at_rest(self.model)), "fit": self._fit, "program": self._fit,
            "rest": lambda: self.jump(replace(self.state, v=np.zeros(self.model.nv), a=np.zeros(self.model.nv))),
        }  # fmt: skip
        asked.get(name, lambda: None)()

    def jump(self, state: State, row: int = -1) -> None:
        """Show another state."""
        self._stop()
        self.state, self.row = state, row
        self.panel.follow(state)

    def jump_to_row(self, row: int) -> None:
        """Show a row of the recording."""
        assert self.subject.recording is not None
        self.jump(self.subject.recording.rows.state(row), row)

    def jump_to_worst(self) -> None:
        """Show the worst row."""
        assert self.subject.recording is not None
        self.jump_to_row(self.subject.recording.worst)

    def _scrub(self) -> None:
        recording = self.subject.recording
        assert recording is not None
        self.jump_to_row(min(round(self.panel.row.value), len(recording.rows) - 1))

    def _stop(self) -> None:
        if self._playing_since is not None:
            self._playing_since = None
            self.panel.show_playing(False)

    def _play(self) -> None:
        """Play from where it is, or from the start where that is the end; or pause."""
        recording = self.subject.recording
        assert recording is not None
        assert recording.rows.time is not None
        if self._playing_since is not None:
            self.jump(self.state, self.row)
            return
        self.row = max(self.row, 0)
        if self.row == len(recording.rows) - 1:
            self.row = 0
        self._change_speed(started=True)
        self.panel.show_playing(True)

    def _change_speed(self, started: bool = False) -> None:
        """From here on the row that is shown counts as played at this moment."""
        recording = self.subject.recording
        assert recording is not None
        assert recording.rows.time is not None
        if started or self._playing_since is not None:
            self._playing_since = time.monotonic() - float(recording.rows.time[self.row]) / float(
                self.panel.speed.value
            )

    def _play_on(self) -> None:
        recording = self.subject.recording
        assert recording is not None
        assert self._playing_since is not None
        now = time.monotonic()
        self.row = recording.at((now - self._playing_since) * float(self.panel.speed.value))
        self.state = recording.rows.state(self.row)
        if self.row == len(recording.rows) - 1:
            self.jump(self.state, self.row)
        elif now - self._followed > FOLLOWING:
            self._followed = now
            self.panel.follow(self.state)

    @property
    def whole_state(self) -> State:
        """The state with what the sliders of the payload add to it."""
        return replace(self.state, loads=(*self.state.loads, *self.panel.load()))

    def _evaluate(self) -> None:
        try:
            self.numbers, self.error = self.evaluator(self.whole_state), ""
        except RttrrError as error:
            self.numbers, self.error = None, error.in_options()

    @property
    def program(self) -> str:
        """Whose numbers the arrows are."""
        names = self.evaluator.names
        return str(self.panel.program.value) if len(names) > 1 else names[0]

    def arrows(self) -> dict[str, Arrows]:
        """The arrows of the state."""
        values = {} if self.numbers is None else self.numbers.values[self.program]
        return arrows(placement(self.model, self.state.q), values, self.whole_state.loads)

    def _fit(self) -> None:
        """Choose scales that suit the state, and the worst one."""
        self._evaluate()
        own = [self.arrows()]
        if (recording := self.subject.recording) is not None and self.row < 0 <= recording.worst:
            state = recording.rows.state(recording.worst)
            with_worst = self.evaluator(state).values[self.program]
            own.append(arrows(placement(self.model, state.q), with_worst, state.loads))
        moments = (*MOMENTS, PAYLOAD[1])
        of_moments = [x for one in own for key, x in one.items() if key in moments]
        of_forces = [x for one in own for key, x in one.items() if key not in moments]
        self.forces, self.moments = fitting(of_forces, self.reach), fitting(of_moments, self.reach)
        self.panel.longer.value = 0

    @property
    def look(self) -> Shown:
        """What is drawn, and how."""
        return self.panel.look(self.forces, self.moments)

    def show(self) -> None:
        """Compute the state and draw it."""
        self._evaluate()
        look, state = self.look, self.whole_state
        where = placement(self.model, state.q)
        if all(np.isfinite(x).all() for x in (where.R, where.p, where.com)):
            self.canvas.draw(where, self.arrows(), look)
        else:
            self.numbers, self.error = None, "the place of a link is beyond doubles: the picture stays as it was"
        self.panel.numbers.content = STYLE + f'<div class="rp">{self._numbers_shown(state)}</div>'
        self.panel.link_numbers.content = STYLE + f'<div class="rp">{self._link_shown(state)}</div>'
        self.panel.scale.content = STYLE + f'<div class="rp"><p><b>{look.scale}</b><br>{legend()}</p></div>'
        recording = self.subject.recording
        if recording is not None:
            worst = f"worst: {recording.place(recording.worst)}: {recording.why}"
            lines = [self.place, worst, *filter(None, [recording.note])]
            self.panel.follow_row(max(self.row, 0), STYLE + _paragraphs(lines))

    @property
    def place(self) -> str:
        """Which state this is."""
        recording = self.subject.recording
        if recording is None or self.row < 0:
            return "a state of your own"
        return f"{recording.place(self.row)} of {recording.name}"

    def _numbers_shown(self, state: State) -> str:
        if self.numbers is None:
            return f'<p class="error">error: {text(self.error)}</p>'
        worst = f"<p>{text(self.numbers.worst)}</p>" if self.numbers.worst else ""
        return joint_table(self.model, state, self.numbers) + worst + quantities_missing(self.numbers)

    def _link_shown(self, state: State) -> str:
        notes = "".join(f"<p>{text(note)}</p>" for note in self.subject.notes)
        if self.numbers is None or not self.model.links:
            return notes
        name = self.program if len(self.numbers.values) > 1 else ""
        own = link_table(self.model, self.panel.link, self.numbers.values[self.program], name)
        return f"{own}<p>the same in Python</p><pre>{text(state_in_python(self.model, state))}</pre>{notes}"


def _paragraphs(lines: list[str]) -> str:
    return '<div class="rp">' + "".join(f"<p>{text(line)}</p>" for line in lines) + "</div>"
