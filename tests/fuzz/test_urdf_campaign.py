"""A sample of the fuzzing campaign, and that its second reader would notice."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rttrr_pin
from fuzz.mutations import mutate
from fuzz.second_reader import UnreadableError, differences, exact
from fuzz.seeds import SMALL
from fuzz.urdf_campaign import case, check
from rttrr_pin.urdf.catalogue import bundled

TEXTS = SMALL | {name: path.read_text(encoding="utf-8") for name, path in bundled().items()}


@pytest.fixture(scope="module", autouse=True)
def _loaded() -> None:
    """yourdfpy takes a second to import, which is no part of a case's time."""
    rttrr_pin.load(SMALL["one"])


def nobody(model: object) -> tuple[str, str]:
    """Asks no oracle."""
    return "", ""


@pytest.mark.parametrize("start", range(0, 300, 50), ids=lambda start: f"seed-0-cases-{start}")
def test_a_sample_of_the_campaign(start: int, tmp_path: Path) -> None:
    for index in range(start, start + 50):
        outcome = check(case(0, index, TEXTS), tmp_path, nobody)
        assert not outcome["failure"], (index, outcome)


@given(st.sampled_from(sorted(TEXTS)), st.randoms(use_true_random=False))
@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mutations_that_hypothesis_draws(tmp_path: Path, name: str, rng: object) -> None:
    outcome = check(mutate(TEXTS[name], rng), tmp_path, nobody)  # type: ignore[arg-type]
    assert not outcome["failure"]


@pytest.mark.parametrize("name", TEXTS)
def test_undamaged_robots_are_read_alike(name: str) -> None:
    model = rttrr_pin.load(TEXTS[name], friction=True).model
    assert differences(TEXTS[name].encode(), model) == []


@pytest.mark.parametrize(
    ("old", "new", "noticed"),
    [
        ('value="1.5"', 'value="1.5000000000000002"', "mass"),
        ('xyz="0.1 -0.2 0.3"', 'xyz="0.1 -0.2 0.30000000000000004"', "centre of mass"),
        ('ixz="-0.02"', 'ixz="0.02"', "tensor"),
        ('rpy="0.1 0 0"', 'rpy="0.1 0 1e-14"', "rotation"),
        ('xyz="0.5 0 -0.25"', 'xyz="0.5 1e-300 -0.25"', "origin"),
        ('<axis xyz="0 0 1"', '<axis xyz="0 1e-14 1"', "axis"),
        ('upper="1.5"', 'upper="1.6"', "upper limit"),
        (' upper="1.5"', "", "upper limit"),
        ('multiplier="-2"', 'multiplier="-2.0000000000000004"', "multiplier"),
        ('offset="0.5"', 'offset="0.6"', "offset"),
        ('<mimic joint="j2"/>', "", "follows another"),
        ('type="revolute"', 'type="continuous"', "type"),
        ('<parent link="g"/>', '<parent link="f"/>', "between"),
        ('<link name="palm"/>', '<link name="palm"/><link name="extra"/>', "links"),
        ('<link name="palm"/>', '<link name="palm"/><g><link><inertial/></link></g>', "the text has 5"),
        ('<link name="palm"/>', "<link name='palm'>&a;</link>", "not XML"),
        ("<robot", "<!DOCTYPE robot><robot", "document type"),
        ('value="1.5"', 'value="1.5kg"', "is no number"),
        ("<mass", '<mass unit="kg"', "unit"),
    ],
)
def test_the_second_reader_notices(old: str, new: str, noticed: str) -> None:
    """A model beside a text that says one thing otherwise."""
    model = rttrr_pin.load(SMALL["mimic"], friction=True).model
    assert old in SMALL["mimic"]
    assert noticed in " ".join(differences(SMALL["mimic"].replace(old, new).encode(), model))


@pytest.mark.parametrize("name", ["0.5\n+0\r\n1", "1\t2", "j\n1"])
@pytest.mark.parametrize("equals", ["=", " = \n"])
def test_line_ends_are_spaces_in_names_that_look_like_numbers_too(name: str, equals: str) -> None:
    text = SMALL["mimic"].replace('name="j1"', f'name{equals}"{name}"').replace('joint="j1"', f"joint{equals}'{name}'")
    model = rttrr_pin.load(text, friction=True).model
    assert text.count(name) > 1 and differences(text.encode(), model) == []


def test_crashes_and_slow_cases_are_failures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise KeyError("oops")

    with monkeypatch.context() as patched:
        patched.setattr(rttrr_pin, "load", broken)
        assert "KeyError" in check(SMALL["one"], tmp_path, nobody)["failure"]
    monkeypatch.setattr("fuzz.urdf_campaign.SLOW", 0.0)
    assert "took" in check(SMALL["one"], tmp_path, nobody)["failure"]


def test_a_reader_that_loses_a_link_is_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = rttrr_pin.load(SMALL["tree"]).model
    short = dataclasses.replace(model, links=model.links[:-1], joints=model.joints[:-1])
    monkeypatch.setattr(rttrr_pin, "load", lambda *_, **__: rttrr_pin.Robot(short))
    assert "the text has" in check(SMALL["tree"], tmp_path, nobody)["failure"]


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["{!r}", "{:.17e}", "{:+.20g}", "{:.30f}"]))
def test_exact_reads_decimals_to_the_nearest_float(value: float, form: str) -> None:
    word = form.format(value)
    if float(word) == 0.0 and any(digit in word.split("e")[0] for digit in "123456789"):
        with pytest.raises(UnreadableError):
            exact(word)
    else:
        assert exact(word) == float(word)
        assert np.isfinite(exact(word))


@pytest.mark.parametrize(
    "word", ["", ".", "e5", "1e", "--1", "0x1", "1_0", "nan", "inf", "1,5", "\u0661", "1e400", "1e-400"]
)
def test_exact_refuses(word: str) -> None:
    with pytest.raises(UnreadableError):
        exact(word)
