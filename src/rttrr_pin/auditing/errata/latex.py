r"""Errata sheets as a LaTeX article that stands by itself; changed terms are in a box of another colour.

An equation is a paragraph of terms, each in a box that is not broken, so that TeX breaks lines and pages before signs.
"""

from __future__ import annotations

from rttrr_pin.auditing.errata.sheet import (
    Block,
    Bullets,
    Display,
    Heading,
    Line,
    Paragraph,
    Sheet,
    Table,
    Words,
    program,
    written,
)
from rttrr_pin.reporting.tex import code, document, escaped

PREAMBLE = r"""\usepackage{xcolor}
\setlength{\fboxsep}{1.5pt}
\newcommand{\term}[1]{\mbox{$#1$}}
\newcommand{\changed}[1]{\colorbox{yellow!60}{\boldmath$#1$}}
\newcommand{\thinspaceorbreak}{\,\allowbreak}
"""


def latex(sheet: Sheet) -> str:
    """The sheet as a LaTeX document."""
    body = "\n\n".join(_block(block) for block in sheet.blocks)
    return document(PREAMBLE, f"{{\\raggedright\\LARGE\\bfseries {escaped(sheet.title)}\\par}}\n\n{body}")


def _block(block: Block) -> str:
    match block:
        case Heading(text, level):
            return rf"\{'sub' * (level - 1)}section*{{{escaped(text)}}}"
        case Paragraph(line):
            return _line(line)
        case Bullets(lines):
            items = "\n".join(rf"\item {{}}{_line(line)}" for line in lines)
            return f"\\begin{{itemize}}\n{items}\n\\end{{itemize}}"
        case Table():
            return _table(block)
        case Display():
            return _display(block)


def _table(table: Table) -> str:
    columns = "".join(
        rf">{{\raggedright\arraybackslash}}p{{{width - 0.02:.3f}\textwidth}}" for width in table.widths
    ) or "l" * len(table.heads)
    head = " & ".join(escaped(text) for text in table.heads)
    rows = "\n".join(" & ".join(_line(cell) for cell in row) + r" \\" for row in table.rows)
    return (
        f"{{\\small\\setlength{{\\LTleft}}{{0pt}}\\setlength{{\\tabcolsep}}{{0.01\\textwidth}}\n"
        f"\\begin{{longtable}}{{{columns}}}\n\\toprule\n{head} \\\\\n\\midrule\n\\endhead\n"
        f"\\bottomrule\n\\endfoot\n{rows}\n\\end{{longtable}}}}"
    )


def _line(line: Line) -> str:
    return written(line, _words, lambda tex: f"${_breakable(tex)}$", _code)


def _words(words: Words) -> str:
    text = escaped(words.text)
    return rf"\textbf{{{text.strip()}}}{' ' if text.endswith(' ') else ''}" if words.strong else text


def _code(text: str) -> str:
    """Typewriter, with breaks allowed behind operators."""
    return code(text).replace("*", r"*\allowbreak{}")


def _breakable(tex: str) -> str:
    """A product that may be broken at its thin spaces: in the column of a table it is often too long."""
    return tex.replace(r" \, ", r" \thinspaceorbreak ")


def _display(display: Display) -> str:
    if display.code:
        return f"\\begin{{verbatim}}\n{program(display)}\n\\end{{verbatim}}"
    terms = "\n".join(rf"\{'changed' if changed else 'term'}{{{_signed(text)}}}" for text, changed in display.terms)
    left = rf"\term{{{display.left} = {{}}}}"
    return f"\\begingroup\\raggedright\\hangindent=2em\\hangafter=1\n{left}\n{terms}\\par\\endgroup"


def _signed(text: str) -> str:
    """A term with its sign, which has the space of an operator though nothing stands before it."""
    return "{} " + text if text[:1] in "+-" else text
