"""From the grammar's trees to symbols, factors and products."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from lark import Token, Tree

from rttrr_pin.auditing.reading.grammar import Node, UnreadableError, divided, end_of, parse, start_of, tokens_of
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Product, braced
from rttrr_pin.derivation.numbers import exact_number

BOLD = {r"\mathbf", r"\boldsymbol", r"\bm", r"\textbf", r"\mathcal", r"\mathsf"}
"""Styles that make another symbol of a letter; the upright ones do not."""


def atom_of(text: str) -> Atom:
    """The symbol that a text spells.

    Raises:
        UnreadableError: it is no symbol, or more than one, or has a sign or a power.
    """
    factor = single_symbol(products_of(parse(tokens_of(text), len(text))))
    if factor is None or factor.atom is None or factor.exponent is not None:
        raise UnreadableError("this is not one symbol alone; give one letter with its scripts", 0)
    return factor.atom


def single_symbol(products: tuple[Product, ...]) -> Factor | None:
    """The factor of a sum that is one symbol, with a power or without; None of any other sum."""
    factor = products[0].factors[0]
    single = len(products) == 1 and len(products[0].factors) == 1 and not products[0].signs
    return factor if single and factor.atom is not None else None


def products_of(tree: Node) -> tuple[Product, ...]:
    """The products of a sum's tree."""
    return tuple(map(_product, _trees(tree)))


def _product(tree: Tree[Token]) -> Product:
    if tree.data == "product":
        return Product((), tuple(map(_factor, _trees(tree))), start_of(tree), end_of(tree))
    signs, product = _trees(tree)
    lines = [line for line in divided(_tokens(signs), "BREAK") if line]
    if not lines:
        raise UnreadableError("a line break stands where a sum begins, wanted a sign or a symbol", start_of(tree))
    values = tuple(tuple(1 if token == "+" else -1 for token in line) for line in lines)
    return replace(_product(product), signs=values, start=start_of(lines[-1][0]))


def _factor(tree: Tree[Token]) -> Factor:
    if tree.data == "operation":
        operator, operand = _trees(tree)
        return replace(_factor(operand), operator="/" if _tokens(operator)[0].type == "SLASH" else "*")
    if tree.data == "led":
        *scripts, inner = _trees(tree)
        return replace(_factor(inner), prefix=_prefix(scripts), start=start_of(tree))
    children = list(tree.children)
    prefix = _prefix(_trees(children.pop(0))) if _rule(children[0]) == "prefix" else ""
    factor = replace(_base(children[0]), start=start_of(tree))
    for script in children[1:]:
        factor = _scripted(factor, script)
    return replace(factor, prefix=prefix) if prefix else factor


def _prefix(scripts: list[Tree[Token]]) -> str:
    """Scripts before a symbol: read as those of a symbol without a letter."""
    empty = Factor(Atom(""), 0)
    for script in scripts:
        empty = _scripted(empty, script)
    atom = empty.atom or Atom("")
    below = f"_{braced(atom.subscript)}" if atom.subscript else ""
    return f"{'' if empty.exponent is None else empty.exponent}{atom.superscript}{below}"


def _base(node: Node) -> Factor:
    start = start_of(node)
    match _rule(node):
        case "bracket":
            (inside,) = _trees(node)
            return Factor(Group(products_of(inside), start_of(inside), end_of(inside)), start)
        case "fraction":
            above, below = _trees(node)
            return Factor(Group(products_of(above), start_of(above), end_of(above), products_of(below)), start)
        case "braced":  # braces print nothing: they may hold one factor, but no sum that would look like a bracket
            products = products_of(_trees(node)[0])
            if len(products) > 1 or products[0].signs or len(products[0].factors) > 1:
                raise UnreadableError("braces print no bracket, so they cannot hold a sum or a product; use ( )", start)
            return products[0].factors[0]
        case "NUMBER":
            return Factor(_number(str(node), start), start)
        case "SHORT_FRACTION":
            numerator, denominator = (int(character) for character in str(node) if character.isdigit())
            return Factor(Fraction(numerator, denominator), start)
    return Factor(_symbol(node), start)


def _number(text: str, start: int) -> Fraction:
    try:
        return exact_number(text)
    except ValueError as error:
        raise UnreadableError(f"this is no number that can be meant: {error}", start) from error


def _symbol(node: Node) -> Atom:
    """A letter with its accents; scripts inside the accent's braces count as outside."""
    if isinstance(node, Token):
        if node.type == "FUNCTION":
            return Atom(r"\cos" if "cos" in node else r"\sin")
        return Atom(str(node))
    if node.data == "word":
        return _word(node)
    mark, nucleus = str(node.children[0]), _symbol(node.children[1])
    if node.data == "styled" and mark not in BOLD:
        return nucleus
    return replace(nucleus, accents=(mark, *nucleus.accents))


def _word(tree: Tree[Token]) -> Atom:
    """What an accent or a style has in braces: letters, and the scripts of the last."""
    word = Factor(Atom(""), start_of(tree))
    for child in tree.children:
        if _rule(child) == "script":
            word = _scripted(word, child)
        elif isinstance(word.body, Atom):
            letter = _symbol(child)
            if word.body.subscript or (word.body.letters and letter.accents):
                raise UnreadableError("one symbol is wanted in these braces", start_of(child))
            word = replace(word, body=replace(letter, letters=word.body.letters + letter.letters))
    if word.exponent is not None or not isinstance(word.body, Atom) or not word.body.letters:
        raise UnreadableError("a symbol without a power is wanted in these braces", word.start)
    return word.body


def _scripted(factor: Factor, script: Node) -> Factor:
    children = script.children if isinstance(script, Tree) else [script]
    rule = _rule(children[0])
    if rule == "DEGREE":
        return _in_degrees(factor, script)
    below = rule in ("SUB_DIGIT", "UNDERSCORE")
    mark = {"TRANSPOSE": "T", "PRIME": "'"}.get(rule) or spelled(children[-1])
    mark = mark.removeprefix("_" if below else "^").strip()
    body = factor.body
    if below:
        if not isinstance(body, Atom) or body.subscript:
            raise UnreadableError("a subscript is wanted on a symbol, and only one", start_of(script))
        return replace(factor, body=replace(body, subscript=mark))
    sign = mark.rstrip("0123456789")
    digits = mark[len(sign) :]
    if digits and sign in ("", "-", "+", "*"):  # q^{*2} is the square of q^*
        if factor.exponent is not None or len(digits) > 4:
            message = "this is no power that can be meant" if len(digits) > 4 else "two powers on one factor; leave one"
            raise UnreadableError(message, start_of(script))
        factor = replace(factor, exponent=int(digits if sign == "*" else mark))
        mark = sign if sign == "*" else ""
    if not mark:
        return factor
    if not isinstance(body, Atom):
        raise UnreadableError("a whole number is wanted as the power of a number or bracket", start_of(script))
    return replace(factor, body=replace(body, superscript=body.superscript + mark))


def _in_degrees(factor: Factor, script: Node) -> Factor:
    """A number of degrees as the part of pi that it is."""
    start, end = factor.start, end_of(script)
    if not isinstance(factor.body, Fraction) or factor.exponent is not None:
        raise UnreadableError("degrees are wanted of a number", start)
    parts = Factor(factor.body / 180, start), Factor(Atom(r"\pi"), start)
    return replace(factor, body=Group((Product((), parts, start, end),), start, end))


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


def _rule(node: Node) -> str:
    return str(node.type if isinstance(node, Token) else node.data)


def _trees(node: Node) -> list[Tree[Token]]:
    return [child for child in node.children if isinstance(child, Tree)] if isinstance(node, Tree) else []


def _tokens(tree: Tree[Token]) -> list[Token]:
    return [child for child in tree.children if isinstance(child, Token)]
