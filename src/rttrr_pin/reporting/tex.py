"""What every LaTeX document of this package has: an article's preamble, escapes, and letters that pdfTeX lacks."""

from __future__ import annotations

import re
from collections.abc import Iterator

CLASS = r"""\documentclass[a4paper,10pt,fleqn]{article}
\usepackage{iftex}
\ifpdftex\usepackage[T1]{fontenc}\fi
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{}
\usepackage[margin=20mm]{geometry}
\usepackage{amsmath}
\usepackage{array,booktabs,longtable}
\setlength{\mathindent}{0pt}
\setlength{\parindent}{0pt}
\setlength{\parskip}{6pt}
"""

SIGNS = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "`": r"\textasciigrave{}", "~": r"\textasciitilde{}",
    "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}", '"': r"''",
}  # fmt: skip
"""What stands for signs that mean something to TeX."""

LAST = "\u017e"
"""The last letter that T1 fonts have, and pdfTeX by itself, but for those in LACKING."""

LACKING = frozenset("ĦħĸĿŀŉŦŧ")

GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "ζ": "zeta", "η": "eta", "θ": "theta",
    "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu", "ξ": "xi", "π": "pi", "ρ": "rho", "σ": "sigma",
    "τ": "tau", "υ": "upsilon", "φ": "varphi", "χ": "chi", "ψ": "psi", "ω": "omega", "ϑ": "vartheta", "ϕ": "phi",
    "Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Φ": "Phi",
    "Ψ": "Psi", "Ω": "Omega",
}  # fmt: skip
"""Letters that formulas have."""

CONTROL = re.compile(r"[^\S\n\u00a0]|[\x00-\x08\x0b-\x1f\x7f-\x9f]")
"""Blanks of any kind, and signs that cannot be printed."""


def document(preamble: str, body: str) -> str:
    """A whole article.

    Args:
        preamble: what this document needs besides what all have.
        body: what stands between begin and end.
    """
    text = CONTROL.sub(lambda character: " " if character[0].isspace() else "?", body)
    letters = "\n".join(_declared(text))
    declared = f"\\ifpdftex\n{letters}\n\\fi\n" if letters else ""
    return f"{CLASS}{preamble}{declared}\\begin{{document}}\n{text}\n\n\\end{{document}}\n"


def escaped(text: str) -> str:
    """Text in which TeX sees only letters; two hyphens are no dash."""
    return re.sub("-(?=-)", "-{}", "".join(SIGNS.get(sign, sign) for sign in text))


def code(text: str) -> str:
    """Text in typewriter."""
    return rf"\texttt{{{escaped(text)}}}"


def _declared(text: str) -> Iterator[str]:
    """Greek letters as those of formulas, and a question mark for all else that pdfTeX has no letter for."""
    for sign in sorted(sign for sign in set(text) if sign > LAST or sign in LACKING):
        shown = rf"\ensuremath{{\{GREEK[sign]}}}" if sign in GREEK else "?"
        yield rf"\DeclareUnicodeCharacter{{{ord(sign):04X}}}{{{shown}}}"
