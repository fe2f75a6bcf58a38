"""MJCF: what is written is the robot, by a comparison of numbers and by what MuJoCo makes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Batch
from rttrr_pin.conformance import cases, level_robot, level_robots
from rttrr_pin.conformance.vectors.mjcf_file import as_mjcf, differences
from support.trees import random_tree

AXIS = '<axis xyz="0 0 1"/>'

EXPRESSED = [name for name in level_robots() if name != "mimic"]


@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", EXPRESSED)
def test_mujoco_reads_the_same_robot(name: str, tmp_path: Path) -> None:
    """All five quantities of the MJCF as MuJoCo compiles it, by our recursion, at states of the level."""
    case = next(x for x in cases(n_states=4) if x.name == name and x.level.id not in ("gravity", "rates"))
    file = tmp_path / "robot.xml"
    file.write_text(as_mjcf(case.robot.model).text)
    read = rttrr_pin.load(file, friction=True)
    ours, theirs = case.robot.model, read.model
    q, v, tau = ([other.index(own) for own in names] for names, other in order(ours, theirs))
    links = [theirs.link_index(link) for link in ours.link_names]
    states = np.zeros((4, theirs.nq)), np.zeros((4, theirs.nv)), np.zeros((4, theirs.nv))
    for x, at, own in zip(states, (q, v, v), (case.batch.q, case.batch.v, case.batch.a), strict=True):
        x[:, at] = own
    expected = replace(case.batch, loads=()).recursion[0]
    result = Batch(theirs, *states).recursion[0]
    for key in "FNfn":
        x, y = getattr(expected, key), getattr(result, key)[:, links]
        size = np.linalg.norm(x, axis=-1).max()
        assert np.abs(x - y).max() <= 1e-12 * size
    assert np.abs(expected.tau - result.tau[:, tau]).max() <= 1e-12 * np.abs(expected.tau).max()


def order(ours: rttrr_pin.Model, theirs: rttrr_pin.Model) -> list[tuple[list[str], list[str]]]:
    """Names of q, v and tau of both."""
    return [(list(getattr(ours, key)), list(getattr(theirs, key))) for key in ("q_names", "v_names", "v_names")]


def moved(text: str, word: str, part: str) -> str:
    """The text with the last number of the first attribute of that kind moved to the next double."""
    at = text.index(f'{word}="', text.index(part)) + len(word) + 2
    end = text.index('"', at)
    *others, last = text[at:end].split()
    return text[:at] + " ".join([*others, repr(float(np.nextafter(float(last), np.inf)))]) + text[end:]


@pytest.mark.parametrize("name", ["effects", "floating"])
@pytest.mark.parametrize("word", ["pos", "euler", "mass", "fullinertia", "axis", "gravity", "armature", "damping"])
def test_a_number_that_is_the_next_double_is_a_difference(word: str, name: str) -> None:
    model = level_robot(name).model
    text = as_mjcf(model).text
    assert not list(differences(text, model))
    if f'{word}="' in text:
        part = "<option" if word == "gravity" else f'<body name="{model.link_names[1]}"'
        assert list(differences(moved(text, word, part), model))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('eulerseq="XYZ"', 'eulerseq="xyz"'),
        ('angle="radian"', 'angle="degree"'),
        ('type="hinge"', 'type="slide"'),
        ("link_2_joint", "link_9_joint"),
        ('body name="link_2"', 'body name="link_9"'),
        (' frictionloss="', ' margin="'),
    ],
)
def test_other_words_are_a_difference(old: str, new: str) -> None:
    model = level_robot("effects").model
    text = as_mjcf(model).text
    assert old in text
    assert list(differences(text.replace(old, new, 1), model))


def test_a_body_on_another_parent_is_a_difference() -> None:
    model = level_robot("tree").model
    other = level_robot("tree").model.links[model.leaves()[0]].name
    text = as_mjcf(model).text
    at = text.index(f'<body name="{other}"')
    end = text.index("</body>", at) + len("</body>")
    moved_out = text[:at] + text[end:].replace("</worldbody>", text[at:end] + "</worldbody>")
    assert list(differences(moved_out, model))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('<joint name="j" type="planar">', "planar"),
        ('<joint name="j" type="floating">', "floating"),
        ('<joint name="j" type="continuous">', "has no mass"),
    ],
)
def test_what_mujoco_has_no_words_for_is_told(body: str, words: str) -> None:
    text = f'<robot name="r"><link name="a"/><link name="b"/>{body}<parent link="a"/><child link="b"/>{AXIS}</joint></robot>'
    result = as_mjcf(rttrr_pin.load(text).model)
    assert not result.text
    assert words in result.reason


@pytest.mark.parametrize("seed", range(6))
def test_what_is_written_of_any_tree_mujoco_compiles(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 6, ("revolute", "prismatic", "fixed"), mimics=False)).model
    result = as_mjcf(model)
    assert result.text, result.reason
    assert mujoco.MjModel.from_xml_string(result.text).nv == model.nv
