"""Whether a fragment of LaTeX can be set by itself: printed equations have errors, and macros of their own."""

from __future__ import annotations

import re

TOKEN = re.compile(r"\\[A-Za-z]+|\\.|.", re.DOTALL)

WITH_ARGUMENT = r"""
\dot \ddot \dddot \bar \hat \widehat \tilde \widetilde \vec \overline \underline \mathrm \mathit \mathbf \mathsf
\mathcal \operatorname \frac \dfrac \tfrac \left \right ^ _
"""
WITHOUT = r"""
\cdot \times \ast \cos \sin \prime \top \ldots \dots \cdots \quad \qquad \, \: \; \! \{ \} \alpha \beta \gamma \delta
\epsilon \varepsilon \zeta \eta \theta \vartheta \iota \kappa \lambda \mu \nu \xi \pi \rho \sigma \tau \upsilon \phi
\varphi \chi \psi \omega \Gamma \Delta \Theta \Lambda \Xi \Pi \Sigma \Upsilon \Phi \Psi \Omega \ell
"""
TAKES_ARGUMENT = frozenset(WITH_ARGUMENT.split())
KNOWN = TAKES_ARGUMENT | frozenset(WITHOUT.split())
"""Commands that amsmath and MathML both have; any other may be a macro of the publication, or text."""

SPECIAL = frozenset('&$#%~<>`|"')
"""Signs that no formula here needs and that mean something elsewhere."""


def settable(tex: str) -> bool:
    """Whether LaTeX and MathML can both set a fragment in one line: braces paired, no script doubled or empty."""
    tokens = [token for token in TOKEN.findall(tex) if not token.isspace()]
    known = [x in KNOWN if x.startswith("\\") else x.isascii() and x not in SPECIAL for x in tokens]
    if not tokens or not all(known):
        return False
    if tokens.count(r"\left") != tokens.count(r"\right"):
        return False
    return _nested(tokens) and _complete(tokens) and _single(tokens)


def _nested(tokens: list[str]) -> bool:
    r"""Braces, and \left with \right between them, each closed by its own."""
    closes = {"}": "{", r"\right": r"\left"}
    waiting: list[str] = []
    for token in tokens:
        if token in closes.values():
            waiting.append(token)
        elif token in closes and (not waiting or waiting.pop() != closes[token]):
            return False
    return not waiting


def _complete(tokens: list[str]) -> bool:
    r"""Whatever takes an argument has one; a delimiter for \left and \right."""
    for token, after in zip(tokens, [*tokens[1:], "}"], strict=True):
        if token in TAKES_ARGUMENT and (after in ("}", "^", "_") or after in TAKES_ARGUMENT - {r"\dot", r"\bar"}):
            return False
        if token in (r"\left", r"\right") and after not in ("(", ")", "[", "]", r"\{", r"\}", "."):
            return False
    return True


def _single(tokens: list[str]) -> bool:
    """No nucleus with two superscripts or two subscripts."""
    taken: list[set[str]] = [set()]
    script = False  # whether what comes next is a script, and no nucleus
    opened: list[bool] = []  # of each brace, whether it opens a script
    for token in tokens:
        if token == "{":
            opened.append(script)
            taken.append(set())
            script = False
        elif token == "}":
            taken.pop()
            if not opened.pop():
                taken[-1] = set()
        elif token in ("^", "_", "'"):
            mark = "^" if token == "'" else token
            if mark in taken[-1]:
                return False
            taken[-1].add(mark)
            script = token != "'"
        elif script:
            script = False
        else:
            taken[-1] = set()
    return True
