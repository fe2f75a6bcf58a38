"""What can go wrong with a user's input, as types.

Every message says what is wrong, what was got, what was wanted and how to mend it; the same facts are attributes.
A disagreement between two programs is not an error: it is a result, and `validate` returns it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

__all__ = [
    "CacheWarning",
    "EquationError",
    "ImplementationError",
    "InputError",
    "LoadWarning",
    "MissingJointError",
    "ModelMismatchError",
    "NumberError",
    "RefusalError",
    "RttrrError",
    "ShapeError",
    "UnknownNameError",
    "UrdfError",
]


class RttrrError(Exception):
    """The base of every error that this package raises on purpose.

    Attributes:
        options: what the command line has in place of words of the message that name an argument of Python.
    """

    def __init__(self, message: str, options: Mapping[str, str] | None = None) -> None:
        super().__init__(message)
        self.options = dict(options or {})

    def in_options(self) -> str:
        """The message in the words of the command line."""
        message = str(self)
        for argument, option in self.options.items():
            message = message.replace(argument, option, 1)
        return message

    def __reduce__(self) -> tuple[object, ...]:
        """By message and attributes: other processes, from which errors come back, do not know the arguments."""
        return _again, (type(self), self.args), vars(self)


def _again(kind: type[RttrrError], arguments: tuple[object, ...]) -> RttrrError:
    """An error that was pickled or copied."""
    error = kind.__new__(kind)
    error.args = arguments
    return error


class InputError(RttrrError, ValueError):
    """A value that was passed cannot be used."""


class CacheWarning(UserWarning):
    """Compiled kernels cannot be kept on disk; all else goes on."""


class LoadWarning(UserWarning):
    """A robot was loaded, and something that its source says, or may say, takes no part in its dynamics."""


class ShapeError(InputError):
    """An array has the wrong shape.

    Attributes:
        name: the argument, such as `"q"`.
        got: its shape.
        wanted: the shape that was expected, in words.
    """

    def __init__(self, message: str, *, name: str, got: tuple[int, ...], wanted: str) -> None:
        super().__init__(message)
        self.name, self.got, self.wanted = name, got, wanted


class NumberError(InputError):
    """A value is no finite real number that float64 can hold (NaN, inf, complex, text, too large, ...).

    Attributes:
        name: the argument, such as `"q"`.
        joint: the joint that the value belongs to; None where the argument has none.
        index: the place of the first bad value in the array; None where the whole array is of a wrong kind.
        value: the bad value, or the kind of the array.
    """

    def __init__(
        self,
        message: str,
        *,
        name: str,
        joint: str | None = None,
        index: tuple[int, ...] | None = None,
        value: object = None,
    ) -> None:
        super().__init__(message)
        self.name, self.joint, self.index, self.value = name, joint, index, value


class UnknownNameError(InputError):
    """A joint, link, robot, ... of that name does not exist.

    Attributes:
        kind: what was looked for, such as `"joint"`.
        got: the name.
        known: the names that would have worked.
    """

    def __init__(self, kind: str, got: object, known: Iterable[str], fix: str = "") -> None:
        self.kind, self.got, self.known = kind, got, tuple(known)
        hint = nearest(got, self.known) + (f"; {fix}" if fix else "")
        super().__init__(f"no {kind} is called {shortened(repr(got))}: {hint}")


class MissingJointError(InputError):
    """A dict of joint values leaves joints out.

    Attributes:
        name: the argument, such as `"q"`.
        missing: the joints left out.
    """

    def __init__(self, name: str, missing: Iterable[str]) -> None:
        self.name, self.missing = name, tuple(missing)
        super().__init__(
            f"{name} lacks {', '.join(self.missing)}: a dict must have one entry for each joint; "
            f"add {', '.join(f'{joint!r}: 0.0' for joint in self.missing)} if they are at rest"
        )


class UrdfError(RttrrError):
    """A URDF cannot be used.

    Attributes:
        source: the file's name, or `"<string>"`.
        line: the line of the element at fault; None where there is none.
        element: the element at fault, such as `link "link_2"`.
    """

    def __init__(self, message: str, *, source: str, line: int | None = None, element: str = "") -> None:
        self.source, self.line, self.element = source, line, element
        where = source if line is None else f"{source}, line {line}"
        if len(message) > LONGEST_MESSAGE:  # names of a file may have millions of letters
            message = f"{message[:LONGEST_MESSAGE]}... ({len(message):,} characters)"
        super().__init__(f"{where}: {element + ': ' if element else ''}{message}")


class EquationError(RttrrError):
    """A file of equations cannot be used.

    Attributes:
        source: the file's name.
        place: the entry at fault, such as `equation 13` or `[[link]] number 2`; empty where it is the whole file.
    """

    def __init__(self, message: str, *, source: str, place: str = "") -> None:
        self.source, self.place = source, place
        super().__init__(f"{source}: {place + ': ' if place else ''}{message}")


class ImplementationError(RttrrError):
    """A program to compare with is missing, or cannot take this robot."""


class RefusalError(ImplementationError):
    """A program says that it does not take this robot, or a payload: it fails at nothing that it offers."""


class ModelMismatchError(ImplementationError):
    """The model that a library built from the file is not what the file says.

    Attributes:
        differences: one line for each number that differs, with the link or joint it belongs to.
        note: what else its reader said of the file.
    """

    def __init__(self, library: str, differences: Iterable[str], note: str = "") -> None:
        self.library, self.differences, self.note = library, tuple(differences), note
        shown = listed(self.differences, 12, "\n  ")
        super().__init__(
            f"{library} built another model than the file describes, so comparing would mislead:\n  {shown}"
            f"{note and chr(10)}{note}"
        )


LONGEST_MESSAGE = 1500
"""Characters of what is said of a file."""

LONGEST, MOST = 200, 2000
"""Characters of a name, and names, that similar ones are looked for among: the search is quadratic in both."""


def shortened(text: str) -> str:
    """Text that may be long by mistake, as a message can show it."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 40]}... ({len(text)} characters)"


def listed(items: Iterable[str], most: int = 6, separator: str = ", ") -> str:
    """The first of several, and how many more there are."""
    items = list(items)
    return separator.join(items[:most] + [f"and {len(items) - most} more"] * (len(items) > most))


def told(error: BaseException, where: str = "") -> str:
    """The kind of an exception of a user's code and what it says, which may be long, or raise another."""
    try:
        text = shortened(" ".join(str(error).split()))
    except Exception:
        text = ""
    return f"{type(error).__name__}{where}{text and ': '}{text}"


def because(error: NotImplementedError) -> str:
    """What a user's code says of what it does not offer, behind a colon; empty where it says nothing."""
    return told(error).removeprefix(type(error).__name__)


def nearest(got: object, known: Iterable[str]) -> str:
    """The hint that follows an unknown name: the closest names that exist, or all of them where none is close."""
    names = list(known)
    close = get_close_matches(
        str(got)[:LONGEST], [name for name in names[:MOST] if len(name) <= LONGEST], n=3, cutoff=0.5
    )
    if close:
        return "did you mean " + " or ".join(close) + "?"
    return f"there are {listed(map(shortened, names), 12)}" if names else "there are none"
