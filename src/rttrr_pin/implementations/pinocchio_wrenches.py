"""Every wrench in a robot as driving forces of Pinocchio, so that its recursion runs on all states in one call.

`rneaInParallel` returns driving forces alone. That of a joint which is locked, at its identity and at rest, is what
crosses it, and the joint changes nothing: of one with six freedoms the whole wrench. So Pinocchio's model is built once
more with such joints where wrenches are wanted, from Pinocchio's own joints, placements and inertias:

| | locked joint | between | its driving force |
|---|---|---|---|
| f, n | of six freedoms | joint i and all that it carries | at the body's origin, in the body's axes |
| F | sliding | joint i and the link's mass, at its centre of mass | what moves that mass alone |
| N | turning | joint i and the link's tensor | what turns that tensor alone |
| payload | of six freedoms | the link and a feather | what the feather takes |

Mass and tensor stand apart for F and N: together, spatial algebra adds v x m v to the moment, which rounds. A feather
is a body of `FEATHER` kg that its joint accelerates by f / `FEATHER`, exact by a power of two. A body is one of
Pinocchio's: what a moving joint carries, with the links that are fixed to it.

Pinocchio's data grows with the cube of the degrees of freedom. So wrenches are read from several models, each with the
part of the tree that they depend on: f, n on what is further out and on the joints further in, F, N on the latter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.processors import processors
from rttrr_pin.implementations.library import Motion
from rttrr_pin.implementations.pinocchio_links import PinLinks, acting
from rttrr_pin.implementations.pinocchio_parallel import FEATHER, Draft, Wrenches, WrenchModel

SLIDING, TURNING = pin.JointModelTranslation, pin.JointModelSpherical
"""Joints of three freedoms."""

FREEDOMS = 80
"""Degrees of freedom that a model may have before another one is begun."""

MOST_BYTES = 2**29
"""Of Pinocchio's data for all models of a robot."""

TENSORS = 4
"""Arrays of nv^3 numbers in Pinocchio's data, for second derivatives: of 500 joints they take 4 GB."""


def data_bytes(nv: int) -> int:
    """What Pinocchio's data takes, where it takes much."""
    return TENSORS * 8 * nv**3


class WrenchModels:
    """The models of a robot whose payloads are at certain links."""

    def __init__(self, model: Model, pin_model: Any, links: PinLinks, loaded: Sequence[int]) -> None:
        """Build them.

        Raises:
            MemoryError: Pinocchio's data would take more than `MOST_BYTES`.
        """
        self._pin_model, self._links, self._loaded = pin_model, links, sorted(set(loaded))
        self._carried_by = [joint.parent for joint in model.joints]
        self._parents = [int(parent) for parent in pin_model.parents]
        self._body, self._massive = links.joint.tolist(), links.massive.tolist()
        self._own = {self._body[i]: i for i in np.flatnonzero(~links.fixed).tolist()}
        crossed = [i for i, acts in enumerate(acting(model, links, self._loaded)) if acts]
        moved = [i for i, massive in enumerate(self._massive) if massive]
        drafts = [
            *map(self._draft_of_crossing, _parts(self._side_by_side(crossed), self._freedoms_around)),
            *map(self._draft_of_net, _parts(self._side_by_side(moved), self._freedoms_inside)),
        ]
        needed = max(1, sum(data_bytes(draft.model.nv) for draft in drafts))
        if needed > MOST_BYTES:
            raise MemoryError(f"{needed:,} bytes of Pinocchio's data")
        threads = max(1, min(processors(), MOST_BYTES // needed))
        self._models = [WrenchModel(draft, pin_model, threads) for draft in drafts]

    def wrenches(self, motion: Motion, loads: Sequence[Load]) -> Wrenches:
        """Run Pinocchio on all states of a batch; loads have a force and moment for each, in their links' axes."""
        rows, links = len(motion.q), len(self._carried_by)
        shapes = ((self._pin_model.nv,), (links, 6), (links, 3), (links, 3))
        result = Wrenches(*(np.zeros((*shape, rows)) for shape in shapes))
        for model in self._models:
            model.run(motion, loads, result)
        return result

    def _side_by_side(self, links: Sequence[int]) -> list[int]:
        """Links in the order of Pinocchio's bodies, in which a branch stands together."""
        return sorted(links, key=lambda i: (self._body[i], i))

    def _inside(self, bodies: Iterable[int]) -> set[int]:
        """The bodies, and all further in; the universe is none."""
        found: set[int] = set()
        for body in bodies:
            while body and body not in found:
                found.add(body)
                body = self._parents[body]
        return found

    def _outside(self, bodies: Iterable[int]) -> set[int]:
        """The bodies, and all further out."""
        found = set(bodies)
        for body, parent in enumerate(self._parents):
            if body and parent in found:
                found.add(body)
        return found

    def _moving(self, bodies: set[int]) -> int:
        return sum(self._pin_model.joints[body].nv for body in bodies if body)

    def _freedoms_around(self, links: Sequence[int]) -> int:
        bodies = {self._body[i] for i in links}
        outside = self._outside(bodies)
        feathers = sum(self._body[link] in outside for link in self._loaded)
        return self._moving(self._inside(bodies) | outside) + 6 * (len(links) + feathers)

    def _freedoms_inside(self, links: Sequence[int]) -> int:
        return self._moving(self._inside({self._body[i] for i in links})) + 6 * len(links)

    def _draft_of_crossing(self, links: Sequence[int]) -> Draft:
        """A model for f, n of these links."""
        draft, bodies = _begun(self._pin_model), {self._body[i] for i in links}
        outside = self._outside(bodies)
        nodes = {-1: 0}  # by link, the joint on which all that it carries hangs; its frame is that of the body
        for body in sorted(self._inside(bodies) | outside | {0}):
            own = self._own.get(body, -1)
            if body:
                nodes[own] = self._add_moving(draft, body, nodes[self._carried_by[own]])
                if body not in bodies and body in outside:
                    draft.model.inertias[nodes[own]] = self._pin_model.inertias[body]
            for i in (i for i, on in enumerate(self._body) if on == body):
                nodes[i] = nodes[own if i == own else self._within(i)]
                if i in links:
                    nodes[i] = draft.crossing[i] = draft.locked(nodes[i], pin.SE3.Identity())
                if body in bodies and self._massive[i]:
                    self._add_body(draft, i, nodes[i])
                if i in self._loaded and body in outside:
                    self._add_feather(draft, i, nodes[self._within(i) if self._links.fixed[i] else i])
        draft.driven = {self._body[i] for i in links if not self._links.fixed[i]}
        return draft

    def _draft_of_net(self, links: Sequence[int]) -> Draft:
        """A model for F, N of these links."""
        draft = _begun(self._pin_model)
        for body in sorted(self._inside({self._body[i] for i in links})):
            self._add_moving(draft, body, draft.moving.get(self._parents[body], 0))
        for i in links:
            parent, mass, tensor = draft.moving.get(self._body[i], 0), self._links.mass[i], self._links.inertia[i]
            place = self._place(i)
            if mass:
                at = draft.F[i] = draft.locked(parent, place * pin.SE3(np.eye(3), self._links.com[i]), SLIDING)
                draft.model.inertias[at] = _inertia(mass, np.zeros(3), np.zeros((3, 3)))
            if tensor.any():
                at = draft.N[i] = draft.locked(parent, place, TURNING)
                draft.model.inertias[at] = _inertia(0.0, np.zeros(3), tensor)
        return draft

    def _within(self, link: int) -> int:
        """The link of the same body on which a fixed link hangs; -1 on the universe."""
        parent = self._carried_by[link]
        return parent if parent >= 0 and self._body[parent] == self._body[link] else self._own.get(self._body[link], -1)

    def _add_moving(self, draft: Draft, body: int, parent: int) -> int:
        """One of Pinocchio's own joints, at its placement on its body."""
        joint, placement = self._pin_model.joints[body], self._pin_model.jointPlacements[body]
        number: int = draft.model.addJoint(parent, joint, placement, self._pin_model.names[body])
        draft.moving[body] = number
        return number

    def _add_body(self, draft: Draft, link: int, on: int) -> None:
        """What a link weighs, on a joint; nothing is rounded where it stands alone and in the joint's axes."""
        links, there = self._links, draft.model.inertias[on]
        own = _inertia(links.mass[link], links.com[link], links.inertia[link])
        own = own.se3Action(self._place(link)) if links.fixed[link] else own
        draft.model.inertias[on] = own if there.isZero(0.0) else there + own

    def _add_feather(self, draft: Draft, link: int, on: int) -> None:
        at = draft.feathers[link] = draft.locked(on, self._place(link))
        draft.model.inertias[at] = pin.Inertia(FEATHER, np.zeros(3), FEATHER * np.eye(3))

    def _place(self, link: int) -> Any:
        """Where a link is on its body."""
        return pin.SE3(self._links.R[link], self._links.p[link])


def _inertia(mass: float, lever: Array, tensor: Array) -> Any:
    """An inertia of any numbers, as Pinocchio's reader takes them; its constructor does not."""
    inertia = pin.Inertia.Zero()
    inertia.mass, inertia.lever, inertia.inertia = float(mass), lever, tensor
    return inertia


def _begun(pin_model: Any) -> Draft:
    draft = Draft()
    draft.model.gravity = pin_model.gravity
    return draft


def _parts(links: Sequence[int], freedoms: Callable[[Sequence[int]], int]) -> Iterator[list[int]]:
    """The links cut into parts, as many in each as its model may have."""
    part: list[int] = []
    for link in links:
        if part and freedoms([*part, link]) > FREEDOMS:
            yield part
            part = []
        part.append(link)
    if part:
        yield part
