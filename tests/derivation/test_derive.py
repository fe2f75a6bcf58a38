"""Closed forms: what is derived, how it is presented, and every output read again, compiled, and held against Pinocchio."""

from __future__ import annotations

import ctypes
import itertools
import subprocess
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot
from rttrr_pin import derivation as symbolic
from rttrr_pin.compile.emit.c import compiler
from rttrr_pin.core.joint import Joint, Mimic
from rttrr_pin.core.joints import PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.derivation import forms
from rttrr_pin.derivation.closed_forms import closed_forms
from rttrr_pin.derivation.collect import Power, Product, Sum
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.ring import Ring, exact
from rttrr_pin.derivation.symbols import Role, dimension_of
from rttrr_pin.derivation.writers import WRITERS
from rttrr_pin.derivation.writers.content import ROOM, width
from rttrr_pin.derivation.writers.printing import Notation
from rttrr_pin.derivation.writers.printing import lines as lines_of
from support import closed_latex
from support.derivations import (
    ALL,
    CASES,
    FAST,
    IDS,
    ONE_AXIS,
    STATES,
    assert_pinocchios,
    derived,
    drawn,
    inputs,
    pinocchios,
    robot,
    written,
)
from support.pdflatex import compiled
from support.serial_chains import EXAMPLES
from support.slow import slow_but
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree


@pytest.mark.one_in(6)
@pytest.mark.parametrize("case", slow_but(FAST, CASES), ids=IDS)
def test_python_gives_what_pinocchio_gives(case: tuple[str, str, str]) -> None:
    module: dict[str, Any] = {}
    exec(compile(written(case, "python"), "closed.py", "exec"), module)
    assert_pinocchios(case[0], {key: module[key](*inputs(case[0], key)) for key in ALL})


@pytest.mark.one_in(4)
@pytest.mark.parametrize("case", slow_but(FAST, CASES), ids=IDS)
def test_c_compiles_without_a_warning_and_gives_what_pinocchio_gives(
    case: tuple[str, str, str], tmp_path: Path
) -> None:
    source, target = tmp_path / "closed.c", tmp_path / "closed.so"
    source.write_text(written(case, "c"))
    flags = ("-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fPIC", "-shared")
    done = subprocess.run([*compiler(), *flags, "-o", target, source, "-lm"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    library = ctypes.CDLL(str(target))
    prefix = robot(case[0]).name
    given = [ctypes.addressof(ctypes.c_char.in_dll(library, f"{prefix}_of_file"))] if case[2] == "letters" else []
    ours = {}
    for key in ALL:
        function, rows = getattr(library, f"{prefix}_{key}"), []
        for k in range(STATES):
            out = np.zeros(derived(*case).quantities[key].shape)
            arrays = [np.ascontiguousarray(x[k]) for x in inputs(case[0], key)]
            function(*(ctypes.c_void_p(x) for x in (*given, *(x.ctypes.data for x in arrays), out.ctypes.data)))
            rows.append(out)
        ours[key] = np.array(rows)
    assert_pinocchios(case[0], ours)


def values(name: str, derivation: symbolic.Derivation) -> dict[str, np.ndarray | float]:
    """The value of each symbol but the steps, one for each state, by what the symbol is, and not by any writer."""
    at, payload = drawn(name)
    found: dict[str, np.ndarray | float] = dict(derivation.robot.parameters.values)
    for letter, x in (("q", at.q), ("v", at.v), ("a", at.a)):
        found |= {f"{letter}_{k}": column for k, column in enumerate(x.T, start=1)}
    for angle in angles(robot(name).model):
        q = angle.multiplier * at.q[:, angle.index - 1] + angle.offset
        found |= {f"s_{angle.suffix}": np.sin(q), f"c_{angle.suffix}": np.cos(q)}
    found |= {f"sign_{k}": np.sign(column) for k, column in enumerate(at.v.T, start=1)}
    tool = ("f_tool_x", "f_tool_y", "f_tool_z", "n_tool_x", "n_tool_y", "n_tool_z")
    return found | dict(zip(tool, payload.T, strict=True))


READ = [(case, "latex") for case in CASES] + [(case, "markdown") for case in CASES[:4]]


@pytest.mark.one_in(9)
@pytest.mark.parametrize(
    "read",
    slow_but([(case, language) for case in FAST for language in ("latex", "markdown")], READ),
    ids=[f"{'-'.join(case)}-{language}" for case, language in READ],
)
def test_formulas_read_again_give_what_pinocchio_gives(read: tuple[tuple[str, str, str], str]) -> None:
    case, language = read
    name, derivation = case[0], derived(*case)
    spelled = {key: symbol.latex for key, symbol in derivation.symbols.items()}
    given = values(name, derivation)
    found = closed_latex.values(written(case, language), spelled, given)
    known = {spelled[key]: value for key, value in given.items()} | found
    ours = {}
    for key, quantity in derivation.quantities.items():
        latex = symbolic.QUANTITIES[key].latex
        pairs = [at[::-1] if key == "M" and at[1] < at[0] else at for at in quantity.terms]
        columns = [np.broadcast_to(known[latex(at)], STATES) for at in pairs]
        ours[key] = np.stack(columns, axis=-1).reshape(STATES, *quantity.shape)
    assert_pinocchios(name, ours)


@pytest.mark.parametrize("case", slow_but(FAST, CASES), ids=IDS)
def test_lines_fit_the_page_and_braces_balance(case: tuple[str, str, str]) -> None:
    text = written(case, "latex")
    assert text.count("{") - text.count(r"\{") == text.count("}") - text.count(r"\}")
    for line in closed_latex.printed_lines(text):
        assert width(line.replace("&", "")) <= ROOM, line
    for _, side in closed_latex.equations(text):
        assert side.count("(") == side.count(")")


def test_a_robot_without_symbols_has_no_table_of_them() -> None:
    """TeX takes no table without rows."""
    still = symbolic.derive(rttrr_pin.load(EXAMPLES["no-joint"]), ["N", "M"], parameters=symbolic.ParameterSymbols())
    assert r"\begin{longtable}" not in WRITERS["latex"](still)
    assert r"\begin{longtable}" in written(CASES[0], "latex")


STRANGE = {
    "joint_0": "Gelenk_für 100% #1 & Co",
    "joint_1": "ŁĦθ関節--{x}$y^2~\\\\input{z}",
    "link_0": "arm_" * 20,
    "link_1": '<größe>|"Σ/1"',
}
"""Names of a robot's file that mean something to TeX, or that its fonts have no letters for."""


@cache
def strangely_named() -> symbolic.Derivation:
    text = random_tree(12, 5, ONE_AXIS).replace('name="tree_12"', 'name="Größe_1 50% #&amp;"')
    for name, strange in STRANGE.items():
        text = text.replace(f'"{name}"', quoteattr(strange))
    return symbolic.derive(rttrr_pin.load(text).model, ALL, "stepwise")


DOCUMENTS = {
    "rttrr": lambda: derived("rttrr", "auto", "letters"),
    "numbers": lambda: derived("two-joints", "expanded", "numbers"),
    "any-axes": lambda: derived("any-axes", "auto", "letters"),
    "strange names": strangely_named,
}


@pytest.mark.tex
@pytest.mark.parametrize("case", DOCUMENTS)
def test_the_document_compiles_and_fits_its_pages(case: str, tmp_path: Path) -> None:
    """A page has some 45 lines of formulas, less where one equation ends and the next begins."""
    text = WRITERS["latex"](DOCUMENTS[case](), "What `--latex FILE` writes.")
    found = compiled(text, tmp_path)
    assert max(found.overfull, default=0.0) < 3.0
    assert text.count("\n") / 60 < found.pages < text.count("\n") / 35 + 2


@pytest.mark.slow
def test_names_from_a_file_stand_in_every_document() -> None:
    """ParameterSymbols of any alphabet are kept; what could end a comment, or begin a command, is not."""
    for language, writer in WRITERS.items():
        text = writer(strangely_named())
        assert "für 100" in text and "関節" in text and "größe" in text, language
        assert r"\input{z}" not in text and "{x}" not in text, language
    assert r"Gelenk\_\allowbreak{}für 100\% \#1 \& Co" in WRITERS["latex"](strangely_named())


def test_a_line_ends_where_few_brackets_are_open() -> None:
    notation = Notation(str, lambda name, power: name, "*", len, "  ")
    one = lambda *factors: Product(Fraction(1), tuple(Power(x, 1) if isinstance(x, str) else x for x in factors))
    long, short = (Sum(tuple(one(letter) for letter in letters)) for letters in ("bcdef", "hijk"))
    expression = Sum((one("g", Sum((one("M", long), one("N", short)))),))
    whole = "g*(M*(b + c + d + e + f) + N*(h + i + j + k))"
    assert lines_of(expression, notation, len(whole)) == [whole]
    assert lines_of(expression, notation, 34) == ["g*(M*(b + c + d + e + f)", "  + N*(h + i + j + k))"]
    for room in range(10, 50):
        found = lines_of(expression, notation, room)
        assert all(len(line) <= room for line in found)
        assert " ".join(line.strip() for line in found) == whole


def test_blocks_of_markdown_are_short_enough_to_render() -> None:
    """Browsers' renderers take some thousand characters; a line that began with + or - would be a list to Markdown."""
    for block in written(CASES[0], "markdown").split("$$\n")[1::2]:
        assert len(block) < 5000
        assert not any(line.startswith(("+", "-", "#", "|")) for line in block.splitlines())


# What is derived


def test_the_equation_of_motion_is_the_sum_of_its_parts() -> None:
    """Exactly, as polynomials, friction and armature included."""
    effects = {joint: JointEffects(0.25, 0.5, 2.0) for joint in robot("rttrr").joint_names}
    model = robot("rttrr").with_joint_effects(effects).model
    closed = closed_forms(symbolic.SymbolicRobot(model, symbolic.default_symbols(model, 5), 5))
    ring = closed.robot.ring
    loads = ring.names(Role.PAYLOAD)
    for i, tau in enumerate(closed.tau):
        moved = [(closed.M[i][j] * closed.robot.a[j] + closed.C[i][j] * closed.robot.v[j]) for j in range(model.nv)]
        payload = sum((ring.derivative(tau, load) * ring[load] for load in loads), ring.lift(0))
        friction = ring[f"v_{i + 1}"] / 2 + 2 * ring[f"sign_{i + 1}"]
        assert tau == sum(moved, closed.g[i] + payload + friction)
        assert not any(
            ring.symbols[x].role in (Role.RATE, Role.ACCELERATION, Role.PAYLOAD) for x in used(ring, closed.g[i])
        )


def branched() -> Model:
    """Branches, a slide, and a joint that follows another; no rotation was rounded, so that laws hold exactly."""
    rng = np.random.default_rng(0)
    x, y, z = np.eye(3)
    joints = (
        Joint("a", REVOLUTE, -1, p=rng.normal(size=3), axis=z),
        Joint("b", PRISMATIC, 0, p=rng.normal(size=3), axis=y),
        Joint("c", REVOLUTE, 0, p=rng.normal(size=3), axis=x),
        Joint("d", REVOLUTE, 2, p=rng.normal(size=3), axis=y, mimic=Mimic(0, -1.5, 0.25)),
    )
    links = tuple(Link(joint.name, 2.0, rng.normal(size=3), np.diag(rng.uniform(size=3))) for joint in joints)
    return Model("branched", Link("base"), links, joints)


@pytest.mark.parametrize("name", ["rttrr", "trtrr", "branched"])
def test_the_rate_of_M_less_twice_C_is_skew_symmetric(name: str) -> None:
    """Exactly: C is made of Christoffel symbols."""
    model = branched() if name == "branched" else robot(name).model
    closed = closed_forms(symbolic.SymbolicRobot(model, symbolic.default_symbols(model)))
    ring, M, C = closed.robot.ring, closed.M, closed.C
    rates = [[rate(closed.robot, entry) for entry in row] for row in M]
    for i, j in itertools.combinations_with_replacement(range(model.nv), 2):
        assert M[i][j] == M[j][i]
        symmetric = rates[i][j] * 2 - C[i][j] * 2 - C[j][i] * 2
        assert ring.reduced(symmetric) == 0


def rate(at: symbolic.SymbolicRobot, x: Any) -> Any:
    """The time derivative of a polynomial in coordinates, sines and cosines."""
    ring = at.ring
    total = sum((ring.derivative(x, q) * ring["v" + q[1:]] for q in ring.names(Role.COORDINATE)), ring.lift(0))
    for angle in angles(at.model):
        s, c = ring[f"s_{angle.suffix}"], ring[f"c_{angle.suffix}"]
        by_angle = ring.derivative(x, str(s)) * c - ring.derivative(x, str(c)) * s
        total += by_angle * ring[f"v_{angle.index}"] * exact(angle.multiplier)
    return ring.reduced(total)


def used(ring: Ring, x: Any) -> set[str]:
    return {name for factors in ring.terms(x) for name, _ in factors}


@pytest.mark.parametrize("case", [CASES[0], CASES[1], CASES[3]], ids=[IDS[0], IDS[1], IDS[3]])
def test_every_term_has_the_dimension_of_its_quantity(case: tuple[str, str, str]) -> None:
    """Of quantities of links, which have one; so no letter, rate or step was lost on the way."""
    derivation = derived(*case)
    ring = derivation.ring
    wanted = {"v_dot_C": "m s^-2", "F": "m kg s^-2", "f": "m kg s^-2", "N": "m^2 kg s^-2", "n": "m^2 kg s^-2"}
    for step in derivation.steps:
        assert {dimension_of(factors, ring.symbols) for factors in step.terms} == {step.symbol.dimension}, (
            step.symbol.name
        )
    for name, dimension in wanted.items():
        for terms in derivation.quantities[name].terms.values():
            assert {str(dimension_of(factors, ring.symbols)) for factors in terms} <= {dimension}, name


@pytest.mark.parametrize("form", ["expanded", "stepwise"])
def test_friction_of_a_joint_that_follows_another(form: str) -> None:
    """Its sign is that of the other's rate, turned where the multiplier is negative."""
    model = branched()
    effects = [JointEffects(0.0 if joint.mimic else 0.1, 0.2, 0.3) for joint in model.joints]
    joints = tuple(replace(joint, effects=own) for joint, own in zip(model.joints, effects, strict=True))
    rubbing = Robot(replace(model, joints=joints))
    module: dict[str, Any] = {}
    exec(WRITERS["python"](symbolic.derive(rubbing, ["tau", "M"], form)), module)
    q, v, a = np.random.default_rng(1).normal(size=(3, STATES, 3))
    assert norm_error(module["tau"](q, v, a), rubbing.inverse_dynamics(q, v, a).tau) <= ROUNDING
    assert norm_error(module["M"](q), rubbing.mass_matrix(q)) <= ROUNDING


def test_auto_writes_out_what_can_be_read_and_names_steps_else() -> None:
    assert derived("rttrr", "auto", "letters").form == "expanded"
    assert not derived("rttrr", "auto", "letters").steps
    long = derived("any-axes", "auto", "letters")
    assert (long.form, "10,000 terms" in long.reason) == ("stepwise", True)
    assert max(len(step.terms) for step in long.steps) < 200


def test_auto_counts_all_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a thousand terms no component has more, but all together do."""
    monkeypatch.setattr(forms, "MOST_TERMS", 1000)
    assert symbolic.derive(robot("rttrr"), ["tau"]).form == "expanded"
    assert symbolic.derive(robot("rttrr"), ["tau", "n"]).form == "stepwise"


def test_the_data_are_the_polynomials() -> None:
    derivation = symbolic.derive(robot("rttrr"), ["g"], "stepwise")
    data = derivation.to_dict()
    assert data["schema"] == 1 and derivation.passed and "rttrr: g" in derivation.summary()
    for entry in data["quantities"]["g"]:
        terms = {tuple(sorted(x["powers"].items())): Fraction(x["coefficient"]) for x in entry["terms"]}
        assert terms == derivation.quantities["g"].terms[entry["index"]]


def test_a_step_needs_only_steps_before_it_and_none_is_idle() -> None:
    derivation = derived("tree-with-followers", "stepwise", "letters")
    seen = set(derivation.symbols) - {step.symbol.name for step in derivation.steps}
    wanted = {name for terms in derivation.all_terms() for factors in terms for name, _ in factors}
    for step in derivation.steps:
        assert {name for factors in step.terms for name, _ in factors} <= seen
        assert step.symbol.name in wanted
        seen.add(step.symbol.name)


def test_a_letter_may_have_the_name_of_a_step() -> None:
    """The paper calls its payload f_6, n_6, as the recursion does what crosses joint 6; here both are 4."""
    model = robot("any-axes").model
    letters = symbolic.default_symbols(model, 3)
    renamed = {symbol.name: replace(symbol, name=symbol.name.replace("_tool_", "_4")) for symbol in letters.symbols}
    slots = {
        slot: {((renamed[next(iter(x))[0][0]].name, 1),): s for x, s in [(x, next(iter(x.values())))]}
        for slot, x in letters.slots.items()
    }
    paper = symbolic.ParameterSymbols(
        tuple(renamed.values()), slots, {renamed[key].name: x for key, x in letters.values.items()}
    )
    module: dict[str, Any] = {}
    exec(WRITERS["python"](symbolic.derive(model, ["n"], "stepwise", paper, 3)), module)
    assert norm_error(module["n"](*inputs("any-axes", "n")), pinocchios("any-axes")["n"]) <= ROUNDING


def test_right_angles_written_with_few_digits_are_read_as_such_on_request() -> None:
    here = 'xyz="0 0 0.09" rpy="{} 0 0"'
    straight = robot("rttrr").model.urdf
    turned, exactly = (straight.replace(here.format(0), here.format(x)) for x in ("1.5708", repr(np.pi / 2)))
    assert turned != straight
    model = rttrr_pin.load(turned).model
    assert symbolic.almost_right_angles(model) == 4  # two zeros, two ones
    assert symbolic.almost_right_angles(robot("rttrr").model) == 0
    long, short = (symbolic.derive(model, ["tau"], "expanded", right_angles=right) for right in (False, True))
    assert short.quantities == symbolic.derive(rttrr_pin.load(exactly), ["tau"], "expanded").quantities
    assert long.count() > short.count()
