"""The LaTeX of printed equations as tokens and trees; `latex.lark` is the grammar."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import files
from typing import Any, cast

from lark import Lark, Token, Tree, UnexpectedToken

from rttrr_pin.errors import RttrrError

Node = Token | Tree[Token]

SHOWN = 24
"""Characters of the text that a message shows from the place at fault."""

OPERATORS = ("TIMES", "STAR", "SLASH")

CLOSES = {"RPAR": "LPAR", "RSQB": "LSQB", "RCURLY": "LCURLY"}
"""Which bracket each closing one ends."""

SYMBOL_ENDS = {"LETTER", "GREEK", "SUB_DIGIT", "SUP_DIGIT", "SUP_STAR", "PRIME", "RBRACE"}
"""What a symbol with its scripts may end with."""

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


def without_time(tokens: Sequence[Token]) -> list[Token]:
    r"""The tokens without the "(t)" behind symbols: `q_2(t)`, `\ddot{q}_{1}{\left(t \right)}`."""
    kept: list[Token] = []
    left = list(tokens)
    while left:
        types = [token.type for token in left[:5]]
        braced = types[:1] == ["LBRACE"]
        inside = types[1:4] if braced else types[:3]
        timed = inside == ["LPAR", "LETTER", "RPAR"] and left[2 if braced else 1] == "t"
        if timed and kept and kept[-1].type in SYMBOL_ENDS and (not braced or types[4:] == ["RBRACE"]):
            left = left[5 if braced else 3 :]
        else:
            kept.append(left.pop(0))
    return kept


def start_of(node: Node) -> int:
    """Where a token or a tree starts."""
    return (node if isinstance(node, Token) else node.meta).start_pos or 0


def end_of(node: Node) -> int:
    """Where a token or a tree ends."""
    return start_of(node) + len(node) if isinstance(node, Token) else node.meta.end_pos


def divided(tokens: Iterable[Token], mark: str) -> list[list[Token]]:
    """The tokens between those of a type."""
    parts: list[list[Token]] = [[]]
    for token in tokens:
        if token.type == mark:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


def parse(tokens: Sequence[Token], end: int) -> Tree[Token]:
    """The tree of a sum; `end` is where it ends in the text, for the message where it stops too soon.

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
            raise _unexpected(token, tokens[:i], end) from error
    return cast("Tree[Token]", tree)


def _unexpected(token: Token, before: Sequence[Token], end: int) -> UnreadableError:
    """The error for a token, with what would have been taken.

    The state in which it was refused does not tell: rules may have been reduced there that the token does not allow.
    """
    state: Any = parser().parse_interactive("", start="sum")
    for earlier in before:
        state.feed_token(earlier)
    accepted = state.accepts()
    wanted = ", ".join(word for word, types in WORDS.items() if types & accepted) or "a script"
    if token.type == "$END":
        return UnreadableError(f"the text ends here, wanted {wanted}; complete it", end)
    if token.type == "OTHER":
        message = f"`{token}` has no place in a sum of products, wanted {wanted}; write it out or take it out"
        return UnreadableError(message, start_of(token))
    return UnreadableError(f"got `{token}`, wanted {wanted}; correct the text", start_of(token))
