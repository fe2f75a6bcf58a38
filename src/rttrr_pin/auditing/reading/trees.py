"""From the grammar's trees to symbols, factors and products."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from lark import Token, Tree

from rttrr_pin.auditing.reading.grammar import UnreadableError, end_of, parse, start_of, tokens_of
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Product, braced

Node = Token | Tree[Token]

BOLD = {r"\mathbf", r"\boldsymbol", r"\bm", r"\textbf", r"\mathcal", r"\mathsf"}
"""Styles that make another symbol of a letter; the upright ones do not."""


def sum_of(text: str) -> tuple[Product, ...]:
    """The products of a text that is one sum on one line.

    Raises:
        UnreadableError: it is none.
    """
    return products_of(parse(tokens_of(text), len(text)))


def atom_of(text: str) -> Atom:
    """The symbol that a text spells.

    Raises:
        UnreadableError: it is no symbol, or more than one, or has a sign or a power.
    """
    products = sum_of(text)
    factor = products[0].factors[0]
    single = len(products) == 1 and len(products[0].factors) == 1 and not products[0].signs and factor.exponent is None
    if not single or factor.atom is None:
        raise UnreadableError("this is not one symbol alone; give one letter with its scripts", 0)
    return factor.atom


def products_of(tree: Tree[Token]) -> tuple[Product, ...]:
    """The products of a sum's tree."""
    products = []
    signs: tuple[tuple[int, ...], ...] = ()
    start = None
    for child in _trees(tree):
        if child.data == "signs":
            signs, start = _signs(child)
            continue
        begin, end = _span(child)
        products.append(Product(signs, _factors(child), begin if start is None else start, end))
        signs, start = (), None
    return tuple(products)


def _signs(tree: Tree[Token]) -> tuple[tuple[tuple[int, ...], ...], int]:
    """The signs line by line, and where the last line's begin."""
    lines: list[list[Token]] = [[]]
    for token in _tokens(tree):
        if token.type == "BREAK":
            lines.append([])
        else:
            lines[-1].append(token)
    printed = [line for line in lines if line]
    if not printed:
        raise UnreadableError(
            "a line break stands where a sum begins, wanted a sign or a symbol", start_of(_tokens(tree)[0])
        )
    return tuple(tuple(1 if token == "+" else -1 for token in line) for line in printed), start_of(printed[-1][0])


def _factors(tree: Tree[Token]) -> tuple[Factor, ...]:
    factors: list[Factor] = []
    operator = ""
    for child in _trees(tree):
        if child.data == "operator":
            operator = "/" if _tokens(child)[0].type == "SLASH" else "*"
            continue
        factors.append(replace(_factor(child), operator=operator))
        operator = ""
    return tuple(factors)


def _factor(tree: Tree[Token]) -> Factor:
    start, end = _span(tree)
    if tree.data == "led":
        led, inner = _trees(tree)
        return replace(_factor(inner), prefix=_prefix([led]), start=start)
    children = list(tree.children)
    prefix = ""
    if isinstance(children[0], Tree) and children[0].data == "prefix":
        prefix = _prefix(_trees(children.pop(0)))
    factor = replace(_base(children[0]), start=start, end=end)
    for script in children[1:]:
        factor = _scripted(factor, script)
    return replace(factor, prefix=prefix) if prefix else factor


def _prefix(scripts: list[Tree[Token]]) -> str:
    plain = Factor(Atom(""), 0, 0)
    for script in scripts:
        plain = _scripted(plain, script)
    atom = plain.body if isinstance(plain.body, Atom) else Atom("")
    below = f"_{braced(atom.subscript)}" if atom.subscript else ""
    return f"{'' if plain.exponent is None else plain.exponent}{atom.superscript}{below}"


def _base(node: Node) -> Factor:
    start, end = _span(node)
    if isinstance(node, Tree) and node.data in ("bracket", "fraction", "braced"):
        sums = [child for child in _trees(node) if child.data == "sum"]
        products = products_of(sums[0])
        if node.data == "braced":
            return _unbraced(products, start)
        divisor = products_of(sums[1]) if node.data == "fraction" else ()
        return Factor(Group(products, *_span(sums[0]), divisor), start, end)
    if isinstance(node, Token) and node.type == "NUMBER":
        return Factor(Fraction(str(node)), start, end)
    if isinstance(node, Token) and node.type == "SHORT_FRACTION":
        above, below = (character for character in node if character.isdigit())
        return Factor(Fraction(int(above), int(below)), start, end)
    return Factor(_symbol(node), start, end)


def _unbraced(products: tuple[Product, ...], start: int) -> Factor:
    """Braces print nothing: they may hold one factor, but no sum that would look like a bracket."""
    if len(products) > 1 or products[0].signs or len(products[0].factors) > 1:
        raise UnreadableError("braces print no bracket, so they cannot hold a sum or a product; use ( )", start)
    return products[0].factors[0]


def _symbol(node: Node) -> Atom:
    """A letter with its accents; scripts inside the accent's braces count as outside."""
    if isinstance(node, Token):
        if node.type == "FUNCTION":
            return Atom(r"\cos" if "cos" in node else r"\sin")
        return Atom(str(node))
    if node.data == "accented":
        inner = _symbol(node.children[1])
        return replace(inner, accents=(str(node.children[0]), *inner.accents))
    if node.data == "styled":
        inner, style = _symbol(node.children[1]), str(node.children[0])
        return replace(inner, accents=(style, *inner.accents)) if style in BOLD else inner
    return _word(node)


def _word(tree: Tree[Token]) -> Atom:
    word = Factor(Atom(""), *_span(tree))
    for child in tree.children:
        if isinstance(child, Tree) and child.data == "script":
            word = _scripted(word, child)
        elif isinstance(word.body, Atom):
            letter = _symbol(child)
            if word.body.subscript or (word.body.letters and letter.accents):
                raise UnreadableError("one symbol is wanted in these braces", _span(child)[0])
            word = replace(word, body=replace(letter, letters=word.body.letters + letter.letters))
    if word.exponent is not None or not isinstance(word.body, Atom) or not word.body.letters:
        raise UnreadableError("a symbol without a power is wanted in these braces", word.start)
    return word.body


def _scripted(factor: Factor, script: Node) -> Factor:
    """A factor with one more superscript or subscript."""
    children = script.children if isinstance(script, Tree) else []
    place = _span(script)[0]
    kind = str(children[0].type) if isinstance(children[0], Token) else ""
    above = kind in ("SUP_DIGIT", "SUP_STAR", "PRIME", "TRANSPOSE", "CARET")
    mark = spelled(children[-1]).removeprefix("^" if above else "_").strip()
    if kind == "TRANSPOSE":
        mark = "T"
    elif kind == "PRIME":
        mark = "'"
    body = factor.body
    if not above:
        if not isinstance(body, Atom) or body.subscript:
            raise UnreadableError("a subscript is wanted on a symbol, and only one", place)
        return replace(factor, body=replace(body, subscript=mark))
    letters = mark.rstrip("0123456789")
    power = mark[len(letters) :]
    if power and letters in ("", "-", "+", "*"):
        if factor.exponent is not None:
            raise UnreadableError("two powers on one factor; leave one", place)
        factor = replace(factor, exponent=int(f"{letters if letters in '+-' else ''}{power}"))
        mark = letters if letters == "*" else ""
    if mark and not isinstance(body, Atom):
        raise UnreadableError("a whole number is wanted as the power of a number or bracket", place)
    if mark and isinstance(body, Atom):
        factor = replace(factor, body=replace(body, superscript=body.superscript + mark))
    return factor


def spelled(node: Node) -> str:
    """The text of a script without blanks and without braces that print nothing."""
    if isinstance(node, Token):
        if node.type in ("SUP_DIGIT", "SUB_DIGIT"):
            return node[0] + node[-1]
        if node.type in ("STAR", "SUP_STAR"):
            return "^*" if node.type == "SUP_STAR" else "*"
        return f"{node} " if node.type in ("GREEK", "FUNCTION") else str(node)
    inner = node.children
    if node.data == "script":
        text = "".join(spelled(child) for child in inner)
        return f"{text[0]}{{{text[1:]}}}" if text[0] in "^_" else text
    if node.data == "accented":
        return f"{inner[0]}{{{spelled(inner[1])}}}"
    return "".join(spelled(child) for child in (inner[1:] if node.data == "styled" else inner))


def _span(node: Node) -> tuple[int, int]:
    if isinstance(node, Token):
        return start_of(node), end_of(node)
    return node.meta.start_pos, node.meta.end_pos


def _trees(tree: Node) -> list[Tree[Token]]:
    return [child for child in tree.children if isinstance(child, Tree)] if isinstance(tree, Tree) else []


def _tokens(tree: Tree[Token]) -> list[Token]:
    return [child for child in tree.children if isinstance(child, Token)]
