r"""Documents as LaTeX articles that compile by themselves; changed terms are in a box of another colour."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rttrr_pin.derivation.writers import document as doc
from rttrr_pin.reporting.tex import code, document, escaped

PREAMBLE = r"""\allowdisplaybreaks
\usepackage{xcolor}
\setlength{\fboxsep}{1.5pt}
\newcommand{\term}[1]{\mbox{$#1$}}
\newcommand{\changed}[1]{\colorbox{yellow!60}{\boldmath$#1$}}
\newcommand{\thinspaceorbreak}{\,\allowbreak}
"""

MOST_LINES = 120
"""Of one environment, unless an equation alone has more: TeX holds it whole."""


def latex(content: doc.Document) -> str:
    """A document as LaTeX."""
    body = "\n\n".join(_block(block) for block in content.blocks)
    # to TeX, an empty line before a display is a paragraph of its own
    body = body.replace("\n\n\\begin{align*}", "\n\\begin{align*}")
    return document(PREAMBLE, f"{{\\raggedright\\LARGE\\bfseries {_words(content.title)}\\par}}\n\n{body}")


def _block(block: doc.Block) -> str:
    match block:
        case doc.Heading(text, level):
            return rf"\{'sub' * (level - 1)}section*{{{_words(text)}}}"
        case doc.Paragraph(text):
            return _text(text)
        case doc.Bullets(items):
            lines = "\n".join(rf"\item {{}}{_text(item)}" for item in items)
            return f"\\begin{{itemize}}\n{lines}\n\\end{{itemize}}"
        case doc.Table():
            return _table(block)
        case doc.Display():
            return _display(block)
        case doc.Equations():
            return "\n".join(_aligned(lines) for lines in block.aligned(MOST_LINES, split=False))


def _table(table: doc.Table) -> str:
    """Columns of given widths, so that one run of TeX sets them."""
    columns = "".join(
        rf">{{\raggedright\arraybackslash}}p{{{width - 0.02:.3f}\textwidth}}" for width in table.widths
    ) or "l" * len(table.heads)
    head = " & ".join(escaped(text) for text in table.heads)
    rows = "\n".join(" & ".join(_text(cell) for cell in row) + r" \\" for row in table.rows)
    return (
        f"{{\\small\\setlength{{\\LTleft}}{{0pt}}\\setlength{{\\tabcolsep}}{{0.01\\textwidth}}\n"
        f"\\begin{{longtable}}{{{columns}}}\n\\toprule\n{head} \\\\\n\\midrule\n\\endhead\n"
        f"\\bottomrule\n\\endfoot\n{rows}\n\\end{{longtable}}}}"
    )


def _text(text: doc.Text) -> str:
    return doc.written(text, _words, lambda words: rf"\textbf{{{words}}}", lambda tex: f"${_breakable(tex)}$", _code)


def _words(text: str) -> str:
    """Names may be broken behind an underscore."""
    return escaped(text).replace(r"\_", r"\_\allowbreak{}")


def _code(text: str) -> str:
    """Typewriter, with breaks allowed behind operators and underscores."""
    return code(text).replace("*", r"*\allowbreak{}").replace(r"\_", r"\_\allowbreak{}")


def _breakable(tex: str) -> str:
    """A product that may be broken at its thin spaces: in the column of a table it is often too long."""
    return tex.replace(r" \, ", r" \thinspaceorbreak ")


def _display(display: doc.Display) -> str:
    """A paragraph of terms, each in a box that is not broken, so that TeX breaks lines and pages before signs."""
    if display.code:
        return f"\\begin{{verbatim}}\n{display.program()}\n\\end{{verbatim}}"
    terms = "\n".join(rf"\{'changed' if changed else 'term'}{{{_signed(text)}}}" for text, changed in display.terms)
    left = rf"\term{{{display.left} = {{}}}}"
    return f"\\begingroup\\raggedright\\hangindent=2em\\hangafter=1\n{left}\n{terms}\\par\\endgroup"


def _signed(text: str) -> str:
    """A term with its sign, which has the space of an operator though nothing stands before it."""
    return "{} " + text if text[:1] in "+-" else text


def _aligned(lines: Sequence[str]) -> str:
    """Lines of equations, with some room between one equation and the next."""
    ends = [r" \\" if after.startswith("& ") else r" \\[1ex]" for _, after in pairwise(lines)]
    body = "\n".join(line + end for line, end in zip(lines, [*ends, ""], strict=True))
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"
