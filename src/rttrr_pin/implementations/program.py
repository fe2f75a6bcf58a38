"""A program of the user's as an implementation: states as JSON lines on its stdin, results as JSON lines on its stdout.

The format stands in docs/notation.md. The program runs as long as it is asked, and is ended in any case: by the end of
its input, and by a signal where it does not leave by itself.
"""

from __future__ import annotations

import json
import shlex
import shutil
import tempfile
import weakref
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, RefusalError, shortened
from rttrr_pin.implementations.allowance import of_printed
from rttrr_pin.implementations.child_process import PATIENCE, Child, ReplyError
from rttrr_pin.implementations.protocol import Batch, Evaluation, shape_of
from rttrr_pin.implementations.text_results import (
    Digits,
    columns_of,
    flattened,
    json_of,
    judged_at,
    number,
    quantities_of,
    trial_states,
)

START = 6
"""Times the limit for a state: how long the first reply may take, in which a program loads its libraries."""

PLACES = ("{urdf}", "{base}", "{gravity}", "{effects}")
"""What stands in a command for the robot: the path of its URDF; fixed or floating; its gravity field, `x,y,z` [m/s^2];
armature, damping and friction of the joints that have any, a JSON object by joint."""


class Program:
    """A command that answers each state with a line.

    Attributes:
        name: the command.
        quantities: those that it replied with when it was tried.
        digits: the significant digits that it is judged at; None where it prints all that float64 has.
        notes: the same as a sentence; none where all digits are there.
    """

    version = ""

    def __init__(self, command: str | Sequence[str], model: Model, seconds: float = 10.0) -> None:
        """Start the program, and try it on three states.

        Args:
            command: as a shell would split it, though none runs; or the words. `PLACES` are filled in.
            model: the robot.
            seconds: how long it may take for a state.

        Raises:
            RefusalError: it replies with an error, in its own words, or needs a URDF where the robot has none.
            ImplementationError: it cannot be started, dies, hangs, or replies with what is no result.
        """
        try:
            self.words = shlex.split(command) if isinstance(command, str) else list(command)
        except ValueError as error:
            raise ImplementationError(f"{command!r} is no command: {error}") from None
        self.name = shortened(" ".join(word if word in PLACES else shlex.quote(word) for word in self.words))
        self.model, self.seconds = model, seconds
        self._child: Child | None = None
        self._filled = self.words
        if any(place in word for word in self.words for place in PLACES):
            folder = tempfile.mkdtemp(prefix="rttrr-pin-")
            weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
            self._filled = _filled(self.words, model, Path(folder))
        self._columns = columns_of(model)
        self.quantities: tuple[str, ...] = ()
        trial = Batch(model, *trial_states(model))
        texts = self._replies(trial)
        self.quantities = tuple(key for key in QUANTITIES if key in texts[0])
        self._digits = {key: Digits.of(text for reply in texts for text in reply[key]) for key in self.quantities}
        self.digits, self.notes = judged_at(self.name, self._digits.values(), "it prints them")

    def __getstate__(self) -> dict[str, object]:
        return vars(self) | {"_child": None}  # a copy starts one of its own

    def evaluate(self, batch: Batch) -> Evaluation:
        """What the program replies, state by state.

        Raises:
            ImplementationError: it dies, hangs, or replies with what is no result; with the end of its stderr.
        """
        replies = self._replies(batch)
        values, halves = {}, {}
        for key in self.quantities:
            texts = [text for reply in replies for text in reply[key]]
            x = np.array([number(text) for text in texts]).reshape(len(batch), *shape_of(self.model, key))
            values[key] = x
            halves[key] = self._digits[key].with_all(Digits.of(texts)).half_units(x)
        return Evaluation(values, of_printed(batch, halves))

    def rest(self) -> None:
        """End the program; it is started again when it is asked again."""
        if self._child is not None:
            child, self._child = self._child, None
            child.end(PATIENCE)

    def _replies(self, batch: Batch) -> list[dict[str, list[str]]]:
        """For each state the texts of the numbers by quantity; the program is ended where one cannot be had."""
        replies: list[dict[str, list[str]]] = []
        try:
            start = self.seconds * (START if self._child is None else 1)
            if self._child is None:
                self._child = Child(self._filled)
                weakref.finalize(self, self._child.end, PATIENCE)
            for line in self._child.ask([request(batch, k) for k in range(len(batch))], self.seconds, start):
                replies.append(self._results(line, f"{self.name}, state {batch.first + len(replies)}"))
        except BaseException as error:
            child, self._child = self._child, None
            last_words = child.end() if child is not None else ""
            if not isinstance(error, (ReplyError, ImplementationError)):
                raise
            at = "" if not self.quantities else f" at state {batch.first + len(replies)}"
            message = f"{self.name} {error}{at}" if isinstance(error, ReplyError) else str(error)
            kind = RefusalError if isinstance(error, RefusedReplyError) else ImplementationError
            raise kind(message + (f"\nits stderr ends:\n{last_words}" if last_words else "")) from None
        return replies

    def _results(self, line: str, where: str) -> dict[str, list[str]]:
        try:
            reply = json_of(line)
        except ValueError as error:
            raise ReplyError(f"wrote what is no reply: {error}; it may write anything else to stderr") from None
        if isinstance(reply, dict) and "error" in reply:
            text = reply["error"] if isinstance(reply["error"], str) else "no text, where one is expected"
            raise RefusedReplyError(f"replied with an error: {shortened(text)}")
        parts = quantities_of(reply, self.name)
        if self.quantities and set(parts) != set(self.quantities):
            raise ReplyError(f"replied with {', '.join(parts)}, and with {', '.join(self.quantities)} before")
        return {key: flattened(value, self._columns[key], f"{where}: {key}") for key, value in parts.items()}


class RefusedReplyError(ReplyError):
    """The program said that it does not take the robot, or the state."""


def _filled(words: Sequence[str], model: Model, folder: Path) -> list[str]:
    """The words of a command with the robot in them; its URDF is written to a folder."""
    whole = " ".join(words)
    if "{urdf}" in whole and not model.urdf:
        raise RefusalError(f"robot {model.name!r} was made from numbers, and {whole} takes a URDF: load it from a file")
    path = folder / "robot.urdf"
    path.write_text(model.urdf)
    effects = {own.name: asdict(own.effects) for own in model.joints if own.effects != JointEffects()}
    values = (
        str(path),
        "floating" if model.floating else "fixed",
        ",".join(map(repr, model.gravity.tolist())),
        json.dumps(effects),
    )
    filled = []
    for word in words:
        for place, value in zip(PLACES, values, strict=True):
            word = word.replace(place, value)
        filled.append(word)
    return filled


def request(batch: Batch, k: int) -> bytes:
    """The line that asks a program for state k of a batch (docs/notation.md)."""
    state: dict[str, object] = {key: getattr(batch, key)[k].tolist() for key in ("q", "v", "a")}
    if batch.loads:
        state["payload"] = [
            {"link": batch.model.link_names[load.link], "axes": "base" if load.in_base else "link"}
            | {key: (x if x.ndim == 1 else x[k]).tolist() for key, x in (("f", load.f), ("n", load.n))}
            for load in batch.loads
        ]
    return json.dumps(state).encode() + b"\n"
