"""The LaTeX of printed equations as tokens and trees; `latex.lark` is the grammar."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Any, cast

from lark import Lark, Token, Tree, UnexpectedToken

from rttrr_pin.errors import RttrrError

SHOWN = 24
"""Characters of the text that a message shows from the place at fault."""

WORDS = {
    "a symbol": {"LETTER", "GREEK", "ACCENT", "STYLE", "EMPTY", "FUNCTION"},
    "a number": {"NUMBER"},
    "+ or -": {"SIGN"},
    "an operator": {"TIMES"},
    "an opening bracket": {"LPAR", "LSQB", "LCURLY"},
    ")": {"RPAR"},
    "]": {"RSQB"},
    r"\}": {"RCURLY"},
    "{": {"LBRACE"},
    "}": {"RBRACE"},
    "the end": {"$END"},
}
"""What a message says was wanted, for the tokens that would have been taken."""


class UnreadableError(RttrrError):
    """A place in the text of an equation that cannot be read; readers turn it into `PrintedComponent.unparsed`.

    Attributes:
        message: what is wrong there.
        start: the place, counted in characters from 0.
    """

    def __init__(self, message: str, start: int) -> None:
        super().__init__(message)
        self.message, self.start = message, start

    def placed(self, text: str) -> str:
        """The message with the place in the text and what stands there."""
        before = text[: self.start]
        line, column = before.count("\n") + 1, self.start - (before.rfind("\n") + 1) + 1
        got = " ".join(text[self.start : self.start + SHOWN].split())
        here = f"at `{got}`" if got else "at the end"
        return f"character {self.start + 1} (line {line}, column {column}), {here}: {self.message}"


@cache
def parser() -> Lark:
    """The parser, made once."""
    grammar = files("rttrr_pin.auditing.reading").joinpath("latex.lark").read_text(encoding="utf-8")
    starts = ["sum", "layout"]
    return Lark(grammar, parser="lalr", lexer="basic", start=starts, propagate_positions=True, maybe_placeholders=False)


def tokens_of(text: str) -> list[Token]:
    """The tokens of any text at all: what the grammar does not know is a token of type OTHER."""
    return list(parser().lex(text))


def start_of(token: Token) -> int:
    """Where a token starts."""
    return token.start_pos or 0


def end_of(token: Token) -> int:
    """Where a token ends."""
    return start_of(token) + len(token)


def parse(tokens: Sequence[Token], end: int) -> Tree[Token]:
    """The tree of a sum.

    Args:
        tokens: of the sum, with their places in the text.
        end: where the sum ends in the text, for the message where it stops too soon.

    Raises:
        UnreadableError: they are no sum.
    """
    if not tokens:
        raise UnreadableError("there is nothing to read here, wanted a sum", end)
    state = parser().parse_interactive("", start="sum")
    for i, token in enumerate([*tokens, Token.new_borrow_pos("$END", "", tokens[-1])]):
        try:
            tree = state.feed_token(token)
        except UnexpectedToken as error:
            raise _explained(token, _accepted(tokens[:i]), end) from error
    return cast("Tree[Token]", tree)


def _accepted(tokens: Sequence[Token]) -> set[str]:
    """The types of token that may follow the beginning of a sum."""
    state: Any = parser().parse_interactive("", start="sum")
    for token in tokens:
        state.feed_token(token)
    return set(state.accepts())


def _explained(token: Token, types: set[str], end: int) -> UnreadableError:
    wanted = ", ".join(word for word, members in WORDS.items() if members & types) or "a script"
    if token.type == "$END":
        return UnreadableError(f"the text ends here, wanted {wanted}; complete it", end)
    if token.type == "OTHER":
        message = f"`{token}` has no place in a sum of products, wanted {wanted}; write it out or take it out"
        return UnreadableError(message, start_of(token))
    return UnreadableError(f"got `{token}`, wanted {wanted}; correct the text", start_of(token))
