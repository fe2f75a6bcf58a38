"""Draws docs/figures/link.svg: link i with what acts on it, in the letters of the recursion.

python docs/figures/link.py            writes the figure
python docs/figures/link.py --check    exits 1 if the committed figure is another
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from xml.sax.saxutils import escape

FIGURE = Path(__file__).with_name("link.svg")

WIDTH, HEIGHT = 760, 330

STYLE = """
  svg { font: italic 17px Georgia, 'Times New Roman', serif; }
  .body { fill: #dbe4ee; stroke: #51606f; stroke-width: 1.5; }
  .joint { fill: #ffffff; stroke: #51606f; stroke-width: 1.5; }
  .axis, .arm { stroke: #51606f; stroke-width: 1.3; fill: none; }
  .arm { stroke-dasharray: 5 4; }
  .net { stroke: #b3541e; fill: none; stroke-width: 2.4; }
  .across { stroke: #1f5fa8; fill: none; stroke-width: 2.4; }
  .drive { stroke: #2c7a4b; fill: none; stroke-width: 2.4; }
  .label { fill: #22303c; }
  .net-label { fill: #b3541e; } .across-label { fill: #1f5fa8; } .drive-label { fill: #2c7a4b; }
  .note { font: 13px system-ui, sans-serif; fill: #51606f; }
  @media (prefers-color-scheme: dark) {
    .body { fill: #2d3843; stroke: #a9b6c2; } .joint { fill: #161b22; stroke: #a9b6c2; }
    .axis, .arm { stroke: #a9b6c2; } .label { fill: #e3e9ef; } .note { fill: #a9b6c2; }
    .net { stroke: #f0975c; } .net-label { fill: #f0975c; } .across { stroke: #78b0ee; }
    .across-label { fill: #78b0ee; } .drive { stroke: #6fcf97; } .drive-label { fill: #6fcf97; }
  }
"""

ORIGIN, CENTRE, TIP = (150.0, 215.0), (345.0, 150.0), (560.0, 120.0)
"""The origin of {i}, the centre of mass of link i, the origin of {i+1}."""


def arrow(kind: str, start: tuple[float, float], end: tuple[float, float]) -> str:
    """A straight arrow: a force, an axis, a position."""
    (x, y), (x_end, y_end) = start, end
    angle = math.atan2(y_end - y, x_end - x)
    head = [(x_end - 10 * math.cos(angle + turn), y_end - 10 * math.sin(angle + turn)) for turn in (0.4, -0.4)]
    (a, b), (c, d) = head
    return (
        f'<path class="{kind}" d="M{x:.1f} {y:.1f} L{x_end:.1f} {y_end:.1f} '
        f'M{a:.1f} {b:.1f} L{x_end:.1f} {y_end:.1f} L{c:.1f} {d:.1f}"/>'
    )


def turn(kind: str, centre: tuple[float, float], radius: float, start: float, end: float) -> str:
    """An arc with a head: a moment; angles in degrees, clockwise on the page."""
    x, y = centre
    at = [(x + radius * math.cos(math.radians(t)), y + radius * math.sin(math.radians(t))) for t in (start, end)]
    (x0, y0), (x1, y1) = at
    along = math.radians(end + 90)
    head = [(x1 - 9 * math.cos(along + t), y1 - 9 * math.sin(along + t)) for t in (0.55, -0.35)]
    (a, b), (c, d) = head
    large = int(end - start > 180)
    return (
        f'<path class="{kind}" d="M{x0:.1f} {y0:.1f} A{radius:.1f} {radius:.1f} 0 {large} 1 {x1:.1f} {y1:.1f} '
        f'M{a:.1f} {b:.1f} L{x1:.1f} {y1:.1f} L{c:.1f} {d:.1f}"/>'
    )


def label(kind: str, x: float, y: float, letter: str, index: str = "") -> str:
    """A letter with its index; without one, as it stands."""
    low = f'<tspan dy="5" font-size="12">{escape(index)}</tspan>' if index else ""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{escape(letter)}{low}</text>'


def note(x: float, y: float, text: str) -> str:
    """Words in upright type."""
    return f'<text class="note" x="{x:.1f}" y="{y:.1f}">{escape(text)}</text>'


def dot(kind: str, place: tuple[float, float], radius: float) -> str:
    """A round mark."""
    return f'<circle class="{kind}" cx="{place[0]:.1f}" cy="{place[1]:.1f}" r="{radius:.1f}"/>'


def figure() -> str:
    """The SVG text."""
    (ox, oy), (cx, cy), (tx, ty) = ORIGIN, CENTRE, TIP
    body = (
        f'<path class="body" d="M{ox - 17} {oy - 22} C{ox + 60} {oy - 82} {cx + 40} {cy - 66} {tx} {ty - 27} '
        f"A27 27 0 0 1 {tx + 8} {ty + 26} C{cx + 90} {cy + 62} {ox + 130} {oy + 46} {ox + 2} {oy + 28} "
        f'A28 28 0 0 1 {ox - 17} {oy - 22} Z"/>'
    )
    parts = [
        body,
        dot("joint", ORIGIN, 15),
        dot("joint", TIP, 13),
        arrow("arm", (ox + 15, oy - 5), (cx - 8, cy + 3)),
        label("label", (ox + cx) / 2 - 6, (oy + cy) / 2 - 8, "r", "Ci"),
        arrow("axis", ORIGIN, (ox + 70, oy + 16)),
        arrow("axis", ORIGIN, (ox - 14, oy - 74)),
        label("label", ox + 76, oy + 24, "{i}"),
        label("label", tx - 6, ty - 42, "{i+1}"),
        dot("net", CENTRE, 4),
        arrow("net", CENTRE, (cx + 92, cy + 54)),
        label("net-label", cx + 98, cy + 66, "F", "i"),
        turn("net", CENTRE, 34, 190, 330),
        label("net-label", cx + 38, cy - 14, "N", "i"),
        arrow("across", (ox - 118, oy - 62), (ox - 18, oy - 12)),
        label("across-label", ox - 108, oy - 70, "f", "i"),
        turn("across", ORIGIN, 42, 95, 215),
        label("across-label", ox - 74, oy + 32, "n", "i"),
        turn("drive", ORIGIN, 60, 268, 330),
        label("drive-label", ox + 44, oy - 56, "τ", "i"),
        arrow("across", (tx + 112, ty - 46), (tx + 16, ty - 6)),
        label("across-label", tx + 96, ty - 56, "− f", "i+1"),
        turn("across", TIP, 38, 325, 440),
        label("across-label", tx + 44, ty + 26, "− n", "i+1"),
        note(16, 285, "F, N: mass times acceleration of the centre of mass, and the moment about it"),
        note(16, 305, "f, n: what link i−1 exerts on link i, at the origin of {i}; τ: their part along the axis"),
    ]
    inside = "\n".join(f"  {part}" for part in parts)
    title = "<title>Link i with F, N, f, n and tau</title>"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 40 {WIDTH} {HEIGHT - 50}" role="img">\n'
        f"  {title}\n  <style>{STYLE}  </style>\n{inside}\n</svg>\n"
    )


def main() -> int:
    """Write the figure, or say whether the committed one is the same."""
    if "--check" in sys.argv[1:]:
        return int(FIGURE.read_text(encoding="utf-8") != figure())
    FIGURE.write_text(figure(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
