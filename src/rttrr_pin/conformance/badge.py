"""A badge that says how far a program gets: SVG, and the JSON of shields.io's endpoint."""

from __future__ import annotations

from html import escape
from pathlib import Path

from rttrr_pin.conformance.results import Conformance
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.files import as_json
from rttrr_pin.reporting.output import shown

LABEL = "rttrr-pin"

GREEN, YELLOW, RED, GREY = "#2e7d32", "#8a6d00", "#b3261e", "#4a4f55"

WIDE, PAD = 6.6, 7
"""Width of a letter at 11 pixels, and what is left beside a text [pixels]."""

MOST = 4
"""Levels that failed, or were not asked, that a badge names; of more it says how many. It names all not offered."""

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="20" role="img" aria-label="{all}">
<title>{all}</title>
<rect width="{split}" height="20" fill="{grey}"/>
<rect x="{split}" width="{rest}" height="20" fill="{colour}"/>
<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">
<text x="{pad}" y="14" textLength="{of_label}">{label}</text>
<text x="{at}" y="14" textLength="{of_message}">{message}</text>
</g>
</svg>
"""


def badge(result: Conformance, target: str) -> str:
    """The text of a badge, by the end of the name of its file: .svg or .json; on stdout it is SVG.

    Raises:
        InputError: the name ends otherwise.
    """
    return endpoint(result) if kind_of(target) == ".json" else svg(result)


def kind_of(target: str) -> str:
    """The end of the name of a badge's file.

    Raises:
        InputError: it is neither .svg nor .json.
    """
    kind = ".svg" if target == "-" else Path(target).suffix.lower()
    if kind not in (".svg", ".json"):
        raise InputError(f"--badge is {target}: expected the name of a .svg or .json file")
    return kind


def colour(result: Conformance) -> str:
    """Green where all was passed; yellow where nothing failed, and not all was asked or offered; else red."""
    return RED if not result.passed else GREEN if result.standing.whole else YELLOW


def endpoint(result: Conformance) -> str:
    """JSON as shields.io's endpoint takes it."""
    return as_json({"schemaVersion": 1, "label": LABEL, "message": result.claim(MOST), "color": colour(result)})


def svg(result: Conformance) -> str:
    """A picture without anything that is loaded."""
    message = shown(result.claim(MOST))
    of_label, of_message = (round(WIDE * len(text)) for text in (LABEL, message))
    split, rest = of_label + 2 * PAD, of_message + 2 * PAD
    return SVG.format(
        width=split + rest,
        all=escape(f"{LABEL}: {message}"),
        split=split,
        rest=rest,
        grey=GREY,
        colour=colour(result),
        pad=PAD,
        at=split + PAD,
        of_label=of_label,
        of_message=of_message,
        label=LABEL,
        message=escape(message),
    )
