"""Damaged and hostile files of equations: TOML, YAML, LaTeX, Python and expressions of symbols."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]

TWO_LINK = (ROOT / "examples/audit_two_link.toml").read_text()

PYTHON = (ROOT / "tests/data/reports/a2_puffer.toml").read_text()

SEEDS = {
    "two links": TWO_LINK,
    "cart-pole": (ROOT / "tests/data/reports/a1_cartpole.toml").read_text(),
    "cart-pole in code": PYTHON,
    "R-P arm": (ROOT / "tests/data/reports/rp_theta_d.toml").read_text(),
}
"""Files that are read."""

Hostile = Callable[[random.Random], tuple[str, str]]
"""A file that is meant to do harm: how its name ends, and its text."""

LATEX_PIECES = (
    r"\dot{\theta}_1", r"\ddot{\theta}_2", "m_1", "l_2", "g", "c_{12}", r"\sin\theta_2", r"\cos(2\theta_1 - \theta_2)",
    "^2", "^{-1}", "_{12}", "(", ")", "[", "]", "{", "}", r"\left(", r"\right)", r"\frac{1}{2}", r"\frac{m_1}{l_1}",
    "+", "-", "/", r"\cdot", "=", "&", r"\\", r"\begin{bmatrix}", r"\end{bmatrix}", r"\tag{1}", ",", ".", "%", "$",
    "9.81", "0.5", "12", "1" * 40, "1" * 41, "1" * 5000, r"\foo", r"\sqrt{2}", "(t)", "{}^4", "'", "\u03b8", "\u4e2d",
    "\U0001d4b3", "\x00", "\x1b[31m", "\u202e", "\n", "  ", r"\mathrm{", r"\text{x}", "^{^{", "_{_{", "c", "s", "!",
)  # fmt: skip
PYTHON_PIECES = (
    "q1", "q2", "qd1", "qdd2", "m", "l", "g", "M", "sin(q2)", "np.cos(q1 - 2*q2)", "cos(", ")", "(", "**2", "**-1",
    "**400", "**10**9", "*", "/", "+", "-", "=", "0.5", "1e308", "1e999999999", "0x" + "f" * 5000, "9" * 5000, "1j",
    "a.b.c", "q[0]", "q1(t)", "lambda: 0", "__import__('os')", "\u03b8", "\u4e2d", "\ufb01", "#", "\\", "\n", "\x00",
    ";", "if", "[x for x in y]", "'" * 3, "f'{q1}'", "~", "not", "None", "...", "0/0", "x" * 3000, "\u0661",
)  # fmt: skip
EXPRESSIONS = (
    "1e999999999", "-1e-999999999", "9" * 5000, "0x" + "f" * 5000, "((2**40)**40)**40", "(((m_1**40)**40)**40)**40",
    "(" * 5000 + "1" + ")" * 5000, "-" * 5000 + "1", "+".join(["m_1"] * 3000), "*".join(["(m_1 + m_2 + l_1)"] * 60),
    "1/0", "m_1/m_2", "0**0", "1e400", "1e308*1e308", "1e-308*1e-308", "\u03b8", "m_1 if m_1 else 1", "nan", "inf", "",
    "\x00", "1_0", "True", "x" * 5000, "m_1.real", "m_1[0]", "lambda: 0", "1j", "'a'", "**", "1e-5000",
)  # fmt: skip
TOKENS = ("[", "]", "{", "}", '"', "'''", "=", ",", ".", "\n", "#", "*a", "&a ", "<<: ", "- ", ": ", "!!int ", "|", ">")


def text_case(rng: random.Random) -> tuple[str, bytes]:
    """How a file of equations is called at its end, and what is in it."""
    kind = rng.random()
    if kind < 0.3:
        return _damaged(rng)
    ending, text = rng.choice(list(HOSTILE.values()) if kind < 0.45 else [latex, python, latex, python, expression])(
        rng
    )
    return ending, text.encode(errors="surrogatepass")


def _damaged(rng: random.Random) -> tuple[str, bytes]:
    """A file with some of its bytes, lines or tokens changed, lost, repeated or moved."""
    text, ending = rng.choice(list(SEEDS.values())), ".toml"
    if rng.random() < 0.5:
        text, ending = yaml.safe_dump(tomllib.loads(text), allow_unicode=True), ".yaml"
    for _ in range(rng.randint(1, 6)):
        text = rng.choice(DAMAGES)(text, rng)
    data = bytearray(text.encode(errors="surrogatepass"))
    if rng.random() < 0.2 and data:
        data[rng.randrange(len(data))] = rng.randrange(256)
    return ending, bytes(data)


def _piece(text: str, rng: random.Random) -> tuple[int, int]:
    start = rng.randrange(len(text) + 1)
    return start, min(len(text), start + rng.randint(1, 40))


def _lost(text: str, rng: random.Random) -> str:
    start, end = _piece(text, rng)
    return text[:start] + text[end:]


def _inserted(text: str, rng: random.Random) -> str:
    start, _ = _piece(text, rng)
    return text[:start] + rng.choice((*TOKENS, *LATEX_PIECES, *PYTHON_PIECES)) + text[start:]


def _repeated(text: str, rng: random.Random) -> str:
    start, end = _piece(text, rng)
    return text[:start] + text[start:end] * rng.choice((2, 10, 300)) + text[end:]


def _lines_lost(text: str, rng: random.Random) -> str:
    return "".join(line for line in text.splitlines(keepends=True) if rng.random() > 0.05)


def _replaced(text: str, rng: random.Random) -> str:
    old = rng.choice(("1", "m", '"', "\\", "theta", "[[", "q"))
    return text.replace(old, rng.choice(("", "2", "[", "9" * 99)))


def _strange_letter(text: str, rng: random.Random) -> str:
    start, _ = _piece(text, rng)
    return text[:start] + chr(rng.choice((0, 7, 27, 0x85, 0x202E, 0xD800, 0xFFFF, 0x1F600, 0x3B8))) + text[start:]


DAMAGES = (_lost, _inserted, _repeated, _lines_lost, _replaced, _strange_letter)


def _with(key: str, value: str, text: str = TWO_LINK) -> str:
    """A file whose first entry of a key has another value."""
    lines = text.split("\n")
    (place,) = [k for k, line in enumerate(lines) if line.startswith(f"{key} =")][:1]
    return "\n".join([*lines[:place], f"{key} = {value}", *lines[place + 1 :]])


def _quoted(text: str) -> str:
    """A text as TOML has it."""
    return '"' + "".join(c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08X}" for c in text) + '"'


def _equation(language: str, text: str, file: str) -> str:
    """A file with one equation."""
    head = file.split("[[equation]]")[0]
    return f'{head}[[equation]]\nquantity = "tau"\njoint = 2\n{language} = {_quoted(text)}\n'


def latex(rng: random.Random) -> tuple[str, str]:
    """An equation of LaTeX pieces in any order."""
    pieces = [rng.choice(LATEX_PIECES) for _ in range(rng.choice((3, 12, 40)))]
    return ".toml", _equation("latex", rng.choice(("", " ", " + ")).join(pieces), TWO_LINK)


def python(rng: random.Random) -> tuple[str, str]:
    """An expression of pieces of Python in any order."""
    pieces = [rng.choice(PYTHON_PIECES) for _ in range(rng.choice((2, 6, 20)))]
    return ".toml", _equation("python", rng.choice(("", " ", " + ", "*", "/")).join(pieces), PYTHON)


def expression(rng: random.Random) -> tuple[str, str]:
    """A robot whose numbers are hostile expressions."""
    text = rng.choice(EXPRESSIONS)
    key = rng.choice(("mass", "com", "origin", "inertia", "gravity", "rpy_degrees"))
    count = {"mass": 1, "inertia": 6}.get(key, 3)
    values = [_quoted(text), *['"0"'] * (count - 1)]
    value = values[0] if count == 1 else f"[{', '.join(values)}]"
    if key in ("inertia", "rpy_degrees"):
        return ".toml", TWO_LINK.replace('mass = "m_2"', f'mass = "m_2"\n{key} = {value}')
    return ".toml", _with(key, value)


def _nested_toml(rng: random.Random) -> tuple[str, str]:
    depth = rng.choice((15, 500, 5000, 100_000))
    return ".toml", f"title = {'[' * depth}{']' * depth}\n" + TWO_LINK.replace("title", "#")


def _dotted_toml(rng: random.Random) -> tuple[str, str]:
    return ".toml", ".".join("a" * rng.choice((100, 5000, 100_000))) + " = 1\n"


def _nested_yaml(rng: random.Random) -> tuple[str, str]:
    depth = rng.choice((15, 500, 5000, 100_000))
    return ".yaml", rng.choice((f"title: {'[' * depth}{']' * depth}", "- " * depth + "a", "{a: " * depth + "}" * depth))


def _alias_bomb(rng: random.Random) -> tuple[str, str]:
    each = rng.choice((2, 10, 100))
    lines = ["l0: &l0 [x]"] + [f"l{k}: &l{k} [{', '.join([f'*l{k - 1}'] * each)}]" for k in range(1, 12)]
    return ".yaml", "\n".join([*lines, f"{rng.choice(('title', 'equation', 'symbol', 'link'))}: *l11"])


def _merge_bomb(rng: random.Random) -> tuple[str, str]:
    lines = ["l0: &l0 {x: 1}"] + [f"l{k}: &l{k} {{<<: [{', '.join([f'*l{k - 1}'] * 10)}]}}" for k in range(1, 12)]
    return ".yaml", "\n".join(lines)


def _loop(rng: random.Random) -> tuple[str, str]:
    return ".yaml", rng.choice(("title: &a [*a]", "&a [*a]", "robot: &a {gravity: *a}", "link: &a [*a]"))


def _values(rng: random.Random) -> tuple[str, str]:
    value = rng.choice((
        *("9" * 4000, "9" * 5000, "0x" + "f" * 5000, "1e400", "nan", "inf", "1979-99-99", "2020-01-01", "true", "[]", "{}"),
        *('"' + "x" * 10_000 + '"', "[[[]]]", "-0", "1_0", '"\\u0000"', '"\\u001b[2J"', '"\u03b8_<i>"', "1" * 41),
    ))  # fmt: skip
    key = rng.choice(
        ("title", "name", "latex", "dimension", "number", "quantity", "joint", "mass", "gravity", "position")
    )
    if rng.random() < 0.5:
        return ".toml", _with(key, value)
    return ".yaml", rng.choice(
        (f"{key}: {value}", f"{key}: !!int {value}", f"? {value}\n: 1", f"equation: [{{{key}: {value}}}]")
    )


def _many_symbols(rng: random.Random) -> tuple[str, str]:
    count = rng.choice((100, 3000, 40_000))
    numbers = ", ".join(map(str, range(count)))
    return (
        ".toml",
        TWO_LINK + f'\n[[symbol]]\nname = "z_<i><k>"\ndimension = "mass"\ni = [{numbers}]\nk = [{numbers}]\n',
    )


def _long_template(rng: random.Random) -> tuple[str, str]:
    return (
        ".toml",
        TWO_LINK
        + f'\n[[symbol]]\nname = "z"\nlatex = "{"<k>" * 50_000}"\nk = ["{"y" * 50_000}"]\ndimension = "mass"\n',
    )


def _many_links(rng: random.Random) -> tuple[str, str]:
    link = '[[link]]\njoint = "revolute about z"\norigin = ["l_1", "0", "0"]\nmass = "m_1"\ncom = ["l_2", "0", "0"]\n'
    return ".toml", link * rng.choice((10, 60, 3000)) + TWO_LINK


def _long_text(rng: random.Random) -> tuple[str, str]:
    term = rng.choice(("m_1 + ", "(", "m_1 (", r"\frac{1}{", "m_1^", "m_1_", "{}^4", r"\dot{", "c_", "1 ", "-", r"\\ "))
    return ".toml", _equation("latex", term * rng.choice((100, 480, 900, 3000, 50_000)) + "m_1", TWO_LINK)


def _long_code(rng: random.Random) -> tuple[str, str]:
    term = rng.choice(("m + ", "(", "m*(", "1/(", "-", "m**", "not ", "a.", "q1(", "sin(", "m*", "(m + l)*", "1/m + "))
    return ".toml", _equation("python", term * rng.choice((100, 480, 900, 3000, 50_000)) + "m", PYTHON)


def _powers(rng: random.Random) -> tuple[str, str]:
    text = rng.choice((
        "(m_1 + m_2)^{400}", "((m_1 + m_2)^{9} (l_1 + l_2)^{9})^{9}", "2^{400} " * 100, "(9.99^{400})^{400}",
        "(" * 200 + "m_1 + 1" + ")^2" * 200, "0.1^{-400} m_1", "m_1^{99999}", r"\frac{1}{m_1}" * 60,
        " + ".join(rf"\frac{{m_1}}{{{p}}}" for p in range(10**39 + 1, 10**39 + 400, 2)),
        " + ".join(rf"\frac{{1}}{{m_{k} + l_{k}}}" for k in range(60)), "(m_1 + l_1 + g)" * 30,
    ))  # fmt: skip
    return ".toml", _equation("latex", text, TWO_LINK)


def _abbreviations(rng: random.Random) -> tuple[str, str]:
    """Each of which uses the one before twice, or more often."""
    of = rng.choice(("{0} {0}", "{0} + {0}", "({0} + m_1)^9", r"\frac{{m_1}}{{{0}}} + {0}", "{1}"))
    head = TWO_LINK.split("[[equation]]")[0]
    names = [rf"\beta_{{{k}}}" for k in range(40)]
    texts = [f"{names[0]} = m_1", *(f"{y} = {of.format(x, y)}" for x, y in pairwise(names))]
    definitions = "".join(f"[[equation]]\nquantity = \"definition\"\nlatex = '''{text}'''\n" for text in texts)
    return ".toml", f"{head}{definitions}[[equation]]\nquantity = \"tau\"\njoint = 1\nlatex = '''{names[-1]}'''\n"


def _many_equations(rng: random.Random) -> tuple[str, str]:
    return ".toml", TWO_LINK + '[[equation]]\nquantity = "definition"\nlatex = "x"\n' * rng.choice((500, 20_000))


def _large(rng: random.Random) -> tuple[str, str]:
    return rng.choice((".toml", ".yaml")), rng.choice(
        ("#" * 2**21, "\n" * 2**20, "a" * 2**20, "- a\n" * 2**18, "x = 1\n" * 2**17)
    )


HOSTILE: dict[str, Hostile] = {
    made.__name__.strip("_"): made
    for made in (
        *(_nested_toml, _dotted_toml, _nested_yaml, _alias_bomb, _merge_bomb, _loop, _values, _many_symbols),
        *(_long_template, _many_links, _long_text, _long_code, _powers, _abbreviations, _many_equations, _large),
    )
}
"""By name."""
