"""Names in a picture, each beside its point and none on another."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

LETTER, LINE = 6.4, 14.0
"""Of a name of 12 pixels: mean width of a letter, height."""

Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""


@dataclass(frozen=True, slots=True)
class Label:
    """A name and where it stands.

    Attributes:
        text: the name.
        x, y: where its line begins, or ends.
        end: whether it ends there.
        tip: the point that it names, where a line leads there; else None.
        marked: whether it stands out.
    """

    text: str
    x: float
    y: float
    end: bool
    tip: tuple[float, float] | None
    marked: bool


def placed(names: Iterable[tuple[str, float, float, bool, bool]], taken: Iterable[Box], frame: Box) -> Iterator[Label]:
    """Places for names, the most wanted first.

    Args:
        names: the text, its point, whether it stands out, and whether it must stand even on others.
        taken: boxes that are better left free.
        frame: the picture.
    """
    boxes = list(taken)
    for text, x, y, marked, must in names:
        best = min(_places(text, x, y), key=lambda place: _cost(place, boxes, frame))
        (left, top, right, bottom), end, far = best
        if _cost(best, boxes, frame) >= 10.0 and not must:
            continue
        boxes.append((left, top, right, bottom))
        yield Label(text, right if end else left, bottom - 3.5, end, (x, y) if far else None, marked)


Place = tuple[Box, bool, bool]


def _places(text: str, x: float, y: float) -> Iterator[Place]:
    """Around a point, near ones first."""
    width = LETTER * len(text)
    for distance in (9.0, 20.0, 34.0, 52.0):
        for side, lift in ((1, 0.0), (-1, 0.0), (1, -1.0), (-1, -1.0), (1, 1.0), (-1, 1.0)):
            across = distance if not lift else distance * 0.75
            left = x + across if side > 0 else x - across - width
            top = y - LINE / 2 + lift * distance * 0.9
            yield (left, top, left + width, top + LINE), side < 0, distance > 9.0


def _cost(place: Place, boxes: Iterable[Box], frame: Box) -> float:
    """What it covers, in hundredths of its own area, and how far it is away."""
    box, _, far = place
    left, top, right, bottom = box
    area = (right - left) * (bottom - top)
    inside = _common(box, frame)
    covered = sum(_common(box, other) for other in boxes) + 4.0 * (area - inside)
    return 100.0 * covered / area + 0.5 * far


def _common(a: Box, b: Box) -> float:
    return max(min(a[2], b[2]) - max(a[0], b[0]), 0.0) * max(min(a[3], b[3]) - max(a[1], b[1]), 0.0)
