"""The names of entries of the cache: whatever a program depends on is in them, and nothing else."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import JointEffects, Robot, Wrench
from rttrr_pin.compile import cache
from rttrr_pin.compile.emit.llvm import LlvmEmitter
from rttrr_pin.compile.variant import fingerprint
from rttrr_pin.core.joint import Joint, Mimic
from rttrr_pin.core.joints import JOINT_TYPES, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model

STATE = ([0.3], [0.4], [0.5])


def rich() -> Model:
    """Every kind of number that a program can depend on."""
    rng = np.random.default_rng(0)
    tensor = np.array([[2.0, 0.1, 0.2], [0.1, 2.5, 0.3], [0.2, 0.3, 3.0]])
    c, s = np.cos(0.3), np.sin(0.3)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    axis = np.array([0.6, 0.0, 0.8])
    links = tuple(Link(f"link_{i}", 1.0 + i, rng.uniform(-1, 1, 3), tensor + i * np.eye(3)) for i in range(3))
    effects = JointEffects(0.1, 0.2, 0.3)
    joints = (
        Joint("a", REVOLUTE, -1, R, rng.uniform(-1, 1, 3), axis, effects=effects),
        Joint("b", PRISMATIC, 0, R, rng.uniform(-1, 1, 3), axis, effects=effects),
        Joint("c", REVOLUTE, 1, R, rng.uniform(-1, 1, 3), axis, mimic=Mimic(0, 0.5, 0.25), effects=effects),
    )
    return Model("rich", Link("base"), links, joints)


def of_one_link(rotated: bool = False) -> Robot:
    link, joint = rich().links[0], rich().joints[0]
    return Robot(Model("one", Link("base"), (replace(link, rotated=rotated),), (replace(joint, parent=-1),)))


def nudged(array: np.ndarray) -> Iterator[np.ndarray]:
    """Each number moved to the next double."""
    for index in np.ndindex(array.shape):
        changed = array.copy()
        changed[index] = np.nextafter(changed[index], np.inf)
        yield changed


def nudged_fields(item: Any, arrays: Sequence[str], numbers: Sequence[str] = ()) -> Iterator[Any]:
    for name in arrays:
        for changed in nudged(getattr(item, name)):
            yield replace(item, **{name: changed})
    for name in numbers:
        yield replace(item, **{name: float(np.nextafter(getattr(item, name), np.inf))})


def neighbours(model: Model) -> Iterator[Model]:
    """The model with one number, type or parent changed at a time."""
    for gravity in nudged(model.gravity):
        yield model.with_gravity(gravity)
    for i, (link, joint) in enumerate(zip(model.links, model.joints, strict=True)):
        links = [*nudged_fields(link, ("com",), ("mass",)), replace(link, rotated=not link.rotated)]
        for a, b in itertools.combinations_with_replacement(range(3), 2):
            tensor = link.inertia.copy()
            tensor[a, b] = tensor[b, a] = np.nextafter(tensor[a, b], np.inf)
            links.append(replace(link, inertia=tensor))
        joints = [*nudged_fields(joint, ("R", "p", "axis")), replace(joint, rotated=not joint.rotated)]
        names = [field.name for field in fields(JointEffects)]
        joints += [replace(joint, effects=effects) for effects in nudged_fields(joint.effects, (), names)]
        joints += [replace(joint, effects=JointEffects(0.3, 0.1, 0.2))]
        if joint.mimic is not None:
            joints += [replace(joint, mimic=x) for x in nudged_fields(joint.mimic, (), ("multiplier", "offset"))]
            joints += [replace(joint, mimic=replace(joint.mimic, joint=1)), replace(joint, mimic=None)]
            joints += [replace(joint, mimic=replace(joint.mimic, rounded=True))]
        joints += [
            replace(joint, type=kind) for kind in JOINT_TYPES.values() if kind.rotates and kind is not joint.type
        ]
        joints += [replace(joint, parent=parent) for parent in range(-1, i) if parent != joint.parent]
        for changed in links:
            yield replace(model, links=(*model.links[:i], changed, *model.links[i + 1 :]))
        for other in joints:
            yield replace(model, joints=(*model.joints[:i], other, *model.joints[i + 1 :]))
    yield replace(model, links=model.links[:2], joints=model.joints[:2])
    yield replace(model, links=model.links[::-1])
    yield model.with_floating_base()
    yield model.without_joint_effects()


def test_every_number_of_a_robot_is_in_its_fingerprint_and_where_it_comes_from() -> None:
    models = [rich(), *neighbours(rich())]
    prints = [fingerprint(model) for model in models]
    assert len(models) > 100
    assert len(set(prints)) == len(prints)
    assert fingerprint(rich()) == prints[0]


def test_equal_numbers_of_other_provenance_share_no_bounds(folder: Path) -> None:
    """A tensor that was turned is rounded, and its robot's bounds are larger than those of one that was read."""
    bounds = [of_one_link(rotated).compile("N_bound")(*STATE)[0] for rotated in (False, True)]
    assert (bounds[1] > bounds[0]).any()


def test_names_and_limits_make_no_other_program() -> None:
    model = rich()
    renamed = replace(model, name="other", links=tuple(replace(link, name=f"{link.name}_") for link in model.links))
    assert fingerprint(renamed) == fingerprint(model)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the entries that were looked for."""
    names: list[str] = []
    read = cache.read
    monkeypatch.setattr(cache, "read", lambda name: (names.append(name), read(name))[1])
    return names


def test_outputs_payloads_and_emitters_never_share_an_entry(asked: list[str]) -> None:
    model = rich()
    empty = np.zeros((0, 2))
    ways = [("tau",), ("tau", "F"), ("F", "tau"), ("F",), ("f",), ("dtau_dq",), ("dtau_dv",), ("dtau_dq", "dtau_dv")]
    for outputs in ways:
        Robot(model).compile(outputs, "numpy")(empty, empty, empty)
    payloads: list[list[Wrench]] = [
        [Wrench((0, 0, 0), link=link, expressed_in=axes) for link, axes in slots]  # type: ignore[arg-type]
        for count in (1, 2)
        for slots in itertools.product(itertools.product(("link_0", "link_1"), ("link", "base")), repeat=count)
    ]
    for payload in payloads:
        Robot(model).compile("tau", "numpy")(empty, empty, empty, payload=payload)
    assert len(set(asked)) == len(asked) == len(ways) + len(payloads)


def test_the_processor_and_the_compiler_are_in_the_name(asked: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A home folder may be shared by machines that differ."""
    for name in ("llvm", "numpy"):
        of_one_link().compile("tau", name)(*STATE)
    monkeypatch.setenv("RTTRR_PIN_CPU_NAME", "generic")
    monkeypatch.setenv("RTTRR_PIN_CPU_FEATURES", "")
    other = LlvmEmitter()
    assert other.identity != of_one_link().compile("tau")._emitter.identity
    assert len(set(asked)) == 2


@pytest.mark.parametrize(
    "parts", [("ab", "c"), ("a", "bc"), ("abc",), ("", "abc"), ("abc", ""), ("ab", "c", "")], ids=repr
)
def test_parts_of_a_name_do_not_run_into_each_other(parts: tuple[str, ...]) -> None:
    others = [("ab", "c"), ("a", "bc"), ("abc",), ("", "abc"), ("abc", ""), ("ab", "c", "")]
    assert [cache.key(*other) == cache.key(*parts) for other in others].count(True) == 1
    assert len(cache.key(*parts)) == 40
