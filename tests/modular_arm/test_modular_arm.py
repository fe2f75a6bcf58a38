"""The bundled arms: the files are what the script builds, and what it builds is what the visuals weigh."""

from __future__ import annotations

import re
from importlib.util import module_from_spec, spec_from_file_location
from itertools import combinations, product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from rttrr_pin.core.solids import Box, Cylinder, Part, RigidBody, Sphere, combine
from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm import CODES, MATERIALS, MODULES, build_arm, build_urdf, modules_of
from support.tolerances import MODEL, ROUNDING, URDF_DIGITS, norm_error

Floats = NDArray[np.float64]

URDF = Path(__file__).parents[2] / "urdf"
RTTRR = URDF / "rttrr.urdf"
TOUCH = 1e-4
"""Solids nearer than this touch [m]; a tenth of a millimetre is below every dimension of the arms."""
PAYLOAD = 3.0
"""What the efforts must hold in the tool [kg]."""

codes = st.text(alphabet="RT", min_size=1, max_size=12)
every_code = pytest.mark.parametrize("code", CODES)


SPEC = spec_from_file_location("arms", Path(__file__).parents[2] / "docs" / "arms.py")
assert SPEC is not None and SPEC.loader is not None
arms = module_from_spec(SPEC)
SPEC.loader.exec_module(arms)


def root_of(code: str) -> ET.Element:
    return ET.parse(URDF / f"{code.lower()}.urdf").getroot()


def numbers(text: str | None) -> Floats:
    assert text is not None
    return np.array([float(word) for word in text.split()])


def attribute(element: ET.Element, path: str, name: str) -> Floats:
    found = element.find(path)
    assert found is not None, path
    return numbers(found.get(name))


def inertia_in(link: ET.Element) -> tuple[float, Floats, Floats]:
    inertia = link.find("inertial/inertia")
    assert inertia is not None
    xx, xy, xz, yy, yz, zz = (float(inertia.attrib[key]) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return (
        float(attribute(link, "inertial/mass", "value")[0]),
        attribute(link, "inertial/origin", "xyz"),
        np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
    )


def moving_links(root: ET.Element) -> list[ET.Element]:
    return [link for link in root.iter("link") if link.find("inertial") is not None]


def random_states(model: Any, count: int, seed: int) -> list[Floats]:
    """Corners of the joint ranges and poses between."""
    rng = np.random.default_rng(seed)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    corners = [np.where(bits, upper, lower) for bits in product([False, True], repeat=model.nq)]
    return corners + [rng.uniform(lower, upper) for _ in range(count)]


# The files are what the script builds -------------------------------------------------------------------------------


@every_code
def test_bundled_file_is_what_the_script_builds(code: str) -> None:
    assert (URDF / f"{code.lower()}.urdf").read_bytes() == build_urdf(code).encode()


def test_no_other_urdf_is_bundled() -> None:
    assert {path.stem.upper() for path in URDF.glob("*.urdf")} == set(CODES)


def test_readme_tables_are_fresh() -> None:
    text = (URDF / "README.md").read_text(encoding="utf-8")
    assert arms.with_tables(text) == text
    assert all(f"| {material.name} | {material.density:g} |" in text for material in MATERIALS)


def test_readme_gives_every_joint_number_of_every_arm() -> None:
    tables = arms.readme_tables()
    for code in CODES:
        rows = tables.partition(f"## {code}: joints")[2].partition("\n## ")[0].splitlines()
        for joint in root_of(code).iter("joint"):
            written = [*attribute(joint, "origin", "xyz")]
            if (limit := joint.find("limit")) is not None:
                written += [float(limit.attrib[key]) for key in ("lower", "upper", "velocity", "effort")]
            cells = [row.split(" | ") for row in rows if row.startswith(f"| {joint.get('name')} |")]
            listed = [float(cell[2]) for cell in cells if len(cell[2].split()) == 1]
            assert listed == written, (code, joint.get("name"))


def test_write_all_writes_the_bundled_files_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_bytes((URDF / "README.md").read_bytes())
    written = arms.write_all(tmp_path)
    assert set(written) == set(tmp_path.iterdir())
    for path in written:
        assert path.read_bytes() == (URDF / path.name).read_bytes()


def test_readme_without_marks_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("no marks", encoding="utf-8")
    with pytest.raises(InputError, match="lacks a mark"):
        arms.write_all(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["README.md"]


# Inertias, by another route: quadrature over the visuals in the file ------------------------------------------------


def box_points(size: Floats) -> tuple[Floats, Floats]:
    """Points and weights of a quadrature over a box that is exact for polynomials of second degree."""
    x, w = np.polynomial.legendre.leggauss(2)
    points = np.array(list(product(x, repeat=3))) * size / 2
    return points, np.array([a * b * c for a, b, c in product(w, repeat=3)]) * np.prod(size) / 8


def round_points(radius: float, length: float | None) -> tuple[Floats, Floats]:
    """The same over a cylinder, or over a ball where there is no length: Gauss along r and z, equal angles around."""
    x, w = np.polynomial.legendre.leggauss(4)
    points, weights = [], []
    for (zeta, wz), (rho, wr), angle in product(
        zip(x, w, strict=True), zip(x, w, strict=True), np.arange(4) * np.pi / 2
    ):
        z = zeta * (radius if length is None else length / 2)
        edge = radius if length is not None else np.sqrt(radius**2 - z**2)
        r = edge * (rho + 1) / 2
        points.append((r * np.cos(angle), r * np.sin(angle), z))
        weights.append(wz * (radius if length is None else length / 2) * wr * edge / 2 * r * np.pi / 2)
    return np.array(points), np.array(weights)


def moments(points: Floats, masses: Floats) -> tuple[float, Floats, Floats]:
    """Mass, centre of mass and inertia about it, of a cloud of mass points."""
    mass = float(masses.sum())
    com = masses @ points / mass
    arms = points - com
    second = (arms * masses[:, None]).T @ arms
    return mass, com, np.trace(second) * np.eye(3) - second


def cloud(shape: ET.Element) -> tuple[Floats, Floats]:
    if shape.tag == "box":
        return box_points(numbers(shape.get("size")))
    length = shape.get("length")
    return round_points(float(shape.attrib["radius"]), None if length is None else float(length))


def densities(code: str) -> dict[str, float]:
    """Those that the header of the file states."""
    header = (URDF / f"{code.lower()}.urdf").read_text(encoding="utf-8").partition("-->")[0]
    found = re.findall(r"^  (\w+): ([0-9.]+)$", header.partition("Densities [kg/m^3]:")[2], re.MULTILINE)
    return {name: float(value) for name, value in found}


@every_code
def test_inertials_are_those_of_the_visuals(code: str) -> None:
    density = densities(code)
    links = moving_links(root_of(code))
    assert len(links) == len(code)
    for link in links:
        points, masses = [], []
        for visual in link.iter("visual"):
            shape, material = visual.find("geometry/*"), visual.find("material")
            assert shape is not None
            assert material is not None
            at, weights = cloud(shape)
            R = pin.rpy.rpyToMatrix(attribute(visual, "origin", "rpy"))
            points.append(at @ R.T + attribute(visual, "origin", "xyz"))
            masses.append(weights * density[material.attrib["name"]])
        wanted: tuple[Any, ...] = moments(np.concatenate(points), np.concatenate(masses))
        for got, want in zip(inertia_in(link), wanted, strict=True):
            assert np.all(np.abs(np.asarray(got) - want) <= URDF_DIGITS * np.abs(want)), link.get("name")


lengths = st.floats(0.01, 1.0)
angles = st.floats(-3.0, 3.0)
solids = st.one_of(
    st.builds(Box, st.tuples(lengths, lengths, lengths)),
    st.builds(Cylinder, lengths, lengths),
    st.builds(Sphere, lengths),
)
parts = st.builds(
    Part,
    st.just("part"),
    solids,
    st.sampled_from(MATERIALS),
    st.tuples(lengths, lengths, lengths),
    st.tuples(angles, angles, angles),
)


def part_cloud(part: Part) -> tuple[Floats, Floats]:
    shape = part.solid
    if isinstance(shape, Box):
        points, weights = box_points(np.array(shape.size))
    else:
        points, weights = round_points(shape.radius, getattr(shape, "length", None))
    return points @ pin.rpy.rpyToMatrix(np.array(part.rpy)).T + np.array(part.xyz), weights * part.material.density


@given(st.lists(parts, min_size=1, max_size=4))
def test_combined_solids_weigh_what_quadrature_says(made_of: list[Part]) -> None:
    body = combine(part.body() for part in made_of)
    points, masses = zip(*(part_cloud(part) for part in made_of), strict=True)
    mass, com, inertia = moments(np.concatenate(points), np.concatenate(masses))
    assert norm_error(body.mass, mass) <= MODEL
    assert norm_error(body.com, com) <= MODEL
    assert norm_error(body.inertia, inertia) <= ROUNDING


@given(parts, st.tuples(lengths, lengths, lengths), st.tuples(angles, angles, angles))
def test_placing_agrees_with_pinocchio(part: Part, xyz: tuple[float, ...], rpy: tuple[float, ...]) -> None:
    body = part.body()
    moved = pin.SE3(pin.rpy.rpyToMatrix(np.array(rpy)), np.array(xyz)).act(
        pin.Inertia(body.mass, body.com, body.inertia)
    )
    placed = body.placed((xyz[0], xyz[1], xyz[2]), (rpy[0], rpy[1], rpy[2]))
    assert norm_error(placed.com, moved.lever) <= MODEL
    assert norm_error(placed.inertia, moved.inertia) <= MODEL


@pytest.mark.parametrize("bad", [0.0, -0.1, float("nan"), float("inf")])
def test_impossible_dimensions_are_refused(bad: float) -> None:
    for make in (
        lambda: Box((0.1, bad, 0.1)),
        lambda: Cylinder(bad, 0.1),
        lambda: Cylinder(0.1, bad),
        lambda: Sphere(bad),
        lambda: RigidBody.of(Sphere(0.1), bad),
    ):
        with pytest.raises(InputError, match="wanted positive finite numbers"):
            make()


def test_no_body_is_refused() -> None:
    with pytest.raises(InputError, match="got no body"):
        combine([])


# What the arms must be ----------------------------------------------------------------------------------------------


@every_code
def test_moving_links_are_possible_bodies_with_nothing_zero(code: str) -> None:
    for link in moving_links(root_of(code)):
        mass, com, inertia = inertia_in(link)
        assert mass > 0
        assert np.all(np.abs(com) >= 1e-3), link.get("name")
        assert np.all(np.abs(inertia) >= 1e-5 * np.trace(inertia)), link.get("name")
        small, middle, large = np.linalg.eigvalsh(inertia)
        assert small > 0
        assert small + middle > large


@every_code
def test_base_and_tool_have_no_inertial_and_no_joint_has_dynamics(code: str) -> None:
    root = root_of(code)
    links = {link.get("name"): link for link in root.iter("link")}
    assert list(links) == ["base", *(f"link_{k}" for k in range(1, len(code) + 1)), "tool"]
    assert links["base"].find("inertial") is None
    assert links["base"].find("visual") is not None
    assert len(links["tool"]) == 0
    assert root.find(".//dynamics") is None


@every_code
def test_collisions_are_the_visuals_and_names_are_unique(code: str) -> None:
    names = []
    for link in root_of(code).iter("link"):
        visuals, collisions = list(link.iter("visual")), list(link.iter("collision"))
        names += [element.get("name") for element in visuals + collisions]
        for visual, collision in zip(visuals, collisions, strict=True):
            for path in ("origin", "geometry"):
                pair = [ET.tostring(found) for e in (visual, collision) if (found := e.find(path)) is not None]
                assert len(pair) == 2
                assert pair[0].strip() == pair[1].strip()
    assert len(set(names)) == len(names)


def geometry(text: str) -> tuple[Any, Any, list[tuple[int, int]]]:
    """The model, its collision solids, and all pairs of them."""
    model = pin.buildModelFromXML(text)
    solids_of = pin.buildGeomFromUrdfString(model, text, pin.COLLISION)
    return model, solids_of, list(combinations(range(solids_of.ngeoms), 2))


def distances_at(model: Any, solids_of: Any, pairs: list[tuple[int, int]], poses: list[Floats]) -> Floats:
    """Between the two solids of each pair, at each pose; negative where they overlap."""
    for pair in pairs:
        solids_of.addCollisionPair(pin.CollisionPair(*pair))
    data, distances = model.createData(), solids_of.createData()
    rows = []
    for q in poses:
        pin.updateGeometryPlacements(model, data, solids_of, distances, q)
        pin.computeDistances(solids_of, distances)
        rows.append([result.min_distance for result in distances.distanceResults])
    return np.array(rows)


def pieces(members: set[int], touching: list[tuple[int, int]]) -> int:
    """How many pieces the members fall into where only touching ones hold together."""
    group = {member: member for member in members}
    for one, other in touching:
        if {one, other} <= members:
            old, new = group[one], group[other]
            group = {member: new if g == old else g for member, g in group.items()}
    return len(set(group.values()))


@pytest.mark.parametrize("code", [*CODES, "RRRRTTR", "RRR"])
def test_no_part_floats(code: str) -> None:
    model, solids_of, pairs = geometry(build_urdf(code))
    distances = distances_at(model, solids_of, pairs, [np.zeros(model.nq)])[0]
    touching = [pair for pair, distance in zip(pairs, distances, strict=True) if distance <= TOUCH]
    owners = [solid.parentJoint for solid in solids_of.geometryObjects]
    assert pieces(set(range(len(owners))), touching) == 1
    for joint in range(model.njoints):
        assert pieces({k for k, owner in enumerate(owners) if owner == joint}, touching) == 1, joint


def test_rttrr_does_not_run_into_itself() -> None:
    model, solids_of, pairs = geometry(RTTRR.read_text(encoding="utf-8"))
    owners = [solid.parentJoint for solid in solids_of.geometryObjects]
    apart = [(one, other) for one, other in pairs if owners[one] != owners[other]]
    assert distances_at(model, solids_of, apart, random_states(model, 60, seed=1)).min() > -TOUCH


def test_rttrr_is_a_small_arm() -> None:
    model = pin.buildModelFromUrdf(str(RTTRR))
    data, tool = model.createData(), model.getFrameId("tool")
    assert 10.0 <= pin.computeTotalMass(model) <= 20.0
    reach = 0.0
    for q in random_states(model, 2000, seed=2):
        pin.framesForwardKinematics(model, data, q)
        reach = max(reach, float(np.hypot(*data.oMf[tool].translation[:2])))
    assert 0.8 <= reach <= 1.1


def test_rttrr_efforts_hold_and_move_a_payload() -> None:
    model = pin.buildModelFromUrdf(str(RTTRR))
    tool = model.frames[model.getFrameId("tool")]
    model.appendBodyToJoint(tool.parentJoint, pin.Inertia(PAYLOAD, np.zeros(3), np.eye(3) * 1e-3), tool.placement)
    data, rng = model.createData(), np.random.default_rng(3)
    for q in random_states(model, 1000, seed=4):
        still = pin.rnea(model, data, q, np.zeros(model.nv), np.zeros(model.nv)).copy()
        v = rng.uniform(-0.5, 0.5, model.nv) * model.velocityLimit
        a = rng.uniform(-1.0, 1.0, model.nv) * model.velocityLimit / 0.5  # full speed in half a second
        moving = pin.rnea(model, data, q, v, a)
        assert np.all(np.abs(still) <= 0.5 * model.effortLimit)
        assert np.all(np.abs(moving) <= model.effortLimit)


# RTTRR is the arm of the paper --------------------------------------------------------------------------------------

PUBLISHED = {
    # joint: type, axis, and which components of its origin the paper's equations leave at zero
    "joint_1": ("revolute", "z", "xy"),
    "joint_2": ("prismatic", "z", "xy"),
    "joint_3": ("prismatic", "y", ""),
    "joint_4": ("revolute", "z", "x"),
    "joint_5": ("revolute", "y", "xy"),
    "tool_joint": ("fixed", None, "xy"),
}


def test_rttrr_has_the_structure_of_the_paper() -> None:
    joints = list(root_of("RTTRR").iter("joint"))
    assert [joint.get("name") for joint in joints] == list(PUBLISHED)
    for joint, (kind, axis, zeros) in zip(joints, PUBLISHED.values(), strict=True):
        assert joint.get("type") == kind
        origin = attribute(joint, "origin", "xyz")
        assert [letter for letter, value in zip("xyz", origin, strict=True) if value == 0.0] == list(zeros)
        assert not attribute(joint, "origin", "rpy").any()
        if axis is not None:
            assert attribute(joint, "axis", "xyz").tolist() == [float(letter == axis) for letter in "xyz"]


def test_every_published_number_has_its_equation() -> None:
    wanted = {(joint, letter) for joint in PUBLISHED for letter in "xyz"}
    wanted |= {(joint, "axis") for joint, (kind, _, _) in PUBLISHED.items() if kind != "fixed"}
    assert set(arms.PAPER) == wanted


def test_rttrr_mass_centres_accelerate_as_the_paper_prints() -> None:
    """Equations (10), (11) and (12), first line, with the lengths l2, l3 and l4 read from the file."""
    model = pin.buildModelFromUrdf(str(RTTRR))
    data, g, rng = model.createData(), 9.81, np.random.default_rng(5)
    joints = {joint.get("name"): attribute(joint, "origin", "xyz") for joint in root_of("RTTRR").iter("joint")}
    (l2, l3), l4 = joints["joint_3"][:2], joints["joint_4"][1]
    links = {link.get("name"): inertia_in(link) for link in moving_links(root_of("RTTRR"))}
    for q in random_states(model, 20, seed=6):
        v, a = rng.uniform(-2, 2, 5), rng.uniform(-5, 5, 5)
        pin.rnea(model, data, q, v, a)
        q3, q4, (v1, _, v3, v4, _), (a1, a2, a3, a4, _) = q[2], q[3], v, a
        s4, c4 = np.sin(q4), np.cos(q4)
        r2, r3, r4 = (links[f"link_{k}"][1] for k in (2, 3, 4))
        eq10 = [-a1 * r2[1] - v1**2 * r2[0], a1 * r2[0] - v1**2 * r2[1], g + a2]
        eq11 = [
            -a1 * q3 - a1 * l3 - v1**2 * l2 - 2 * v3 * v1 - a1 * r3[1] - v1**2 * r3[0],
            a1 * l2 - v1**2 * q3 - v1**2 * l3 + a3 + a1 * r3[0] - v1**2 * r3[1],
            g + a2,
        ]
        eq12_x = (
            *(-c4 * a1 * q3, -c4 * a1 * l3, -c4 * v1**2 * l2, -2 * c4 * v3 * v1, -c4 * a1 * l4, s4 * a1 * l2),
            *(-s4 * v1**2 * q3, -s4 * v1**2 * l3, s4 * a3, -s4 * v1**2 * l4, -r4[1] * a1, -r4[1] * a4),
            *(-r4[0] * v1**2, -2 * r4[0] * v1 * v4, -r4[0] * v4**2),
        )
        for k, wanted in ((2, eq10), (3, eq11)):
            assert norm_error(acceleration(data, k, links), wanted) <= ROUNDING
        assert abs(acceleration(data, 4, links)[0] - sum(eq12_x)) <= ROUNDING * np.abs(eq12_x).sum()


def acceleration(data: Any, k: int, links: dict[str | None, tuple[float, Floats, Floats]]) -> Floats:
    """Of the centre of mass of link k, minus gravity, in {k}; by rigid-body kinematics from Pinocchio's a_gf and v."""
    com = links[f"link_{k}"][1]
    v, a = data.v[k], data.a_gf[k]
    linear = a.linear + np.cross(v.angular, v.linear)
    return np.asarray(linear + np.cross(a.angular, com) + np.cross(v.angular, np.cross(v.angular, com)))


def test_heights_of_rttrr_move_no_driving_torque() -> None:
    """As urdf/README.md claims: h2 to h5 enter bearing moments only, and h1 nothing."""
    model, taller = (pin.buildModelFromUrdf(str(RTTRR)) for _ in range(2))
    rng = np.random.default_rng(7)
    for k in range(1, 6):
        placement = taller.jointPlacements[k]
        placement.translation = placement.translation + np.array([0.0, 0.0, rng.uniform(0.1, 0.5)])
        taller.jointPlacements[k] = placement
    for q in random_states(model, 20, seed=8):
        v, a = rng.uniform(-2, 2, 5), rng.uniform(-5, 5, 5)
        data, other = model.createData(), taller.createData()
        assert norm_error(pin.rnea(taller, other, q, v, a), pin.rnea(model, data, q, v, a)) <= ROUNDING
        assert norm_error(other.f[1].angular, data.f[1].angular) > URDF_DIGITS


# Two parsers read the same arm --------------------------------------------------------------------------------------


@every_code
def test_pinocchio_and_yourdfpy_read_what_the_modules_say(code: str) -> None:
    path = str(URDF / f"{code.lower()}.urdf")
    model, robot, arm = pin.buildModelFromUrdf(path), yourdfpy.URDF.load(path, load_meshes=False), build_arm(code)
    assert [*model.names][1:] == [*robot.actuated_joint_names] == [*arm.joint_names]
    for k, (module, origin, body) in enumerate(zip(arm.modules, arm.origins, arm.bodies, strict=False), start=1):
        joint = robot.joint_map[f"joint_{k}"]
        assert model.joints[k].shortname() == f"JointModel{module.key[-2].replace('T', 'P')}{module.key[-1].upper()}"
        assert (joint.type, tuple(joint.axis)) == (module.type, module.axis)
        for placement in (model.jointPlacements[k].homogeneous, joint.origin):
            assert norm_error(placement[:3, 3], origin) <= MODEL
            assert np.array_equal(placement[:3, :3], np.eye(3))
        limits = (module.lower, module.upper, module.velocity, module.effort)
        read = (model.lowerPositionLimit, model.upperPositionLimit, model.velocityLimit, model.effortLimit)
        assert tuple(vector[k - 1] for vector in read) == limits
        read_by_yourdfpy = joint.limit
        assert tuple(getattr(read_by_yourdfpy, key) for key in ("lower", "upper", "velocity", "effort")) == limits
        assert norm_error(model.inertias[k].mass, body.mass) <= URDF_DIGITS
        assert norm_error(model.inertias[k].lever, body.com) <= URDF_DIGITS
        assert norm_error(model.inertias[k].inertia, body.inertia) <= URDF_DIGITS
    tool = model.frames[model.getFrameId("tool")]
    assert norm_error(tool.placement.translation, arm.origins[-1]) <= MODEL


# Any code -----------------------------------------------------------------------------------------------------------

AXES = {  # worked out by hand from the rule: T alternates over the code, R within a run
    "RTTRR": "z z y z y",
    "TRR": "z z y",
    "TRTR": "z z y z",
    "TRTRR": "z z y z y",
    "TRTTR": "z z y z z",
    "R": "z",
    "T": "z",
    "RRRR": "z y z y",
    "TTT": "z y z",
    "RTRRTRT": "z z z y y z z",
}


@pytest.mark.parametrize(("code", "axes"), AXES.items())
def test_axes_follow_the_rule(code: str, axes: str) -> None:
    assert [module.key[-1] for module in modules_of(code)] == axes.split()


@pytest.mark.parametrize(
    ("code", "wrist"), [("RTTRR", 2), ("TRTR", 1), ("R", 0), ("RR", 1), ("RRR", 2), ("TRRRR", 2), ("RRT", 0)]
)
def test_only_the_last_revolutes_are_of_wrist_size(code: str, wrist: int) -> None:
    sizes = [module.key.startswith("wrist") for module in modules_of(code)]
    assert sizes == [False] * (len(code) - wrist) + [True] * wrist


def test_every_module_is_in_reach_of_a_code() -> None:
    used = {module.key for code in ("RRRR", "TT", "TRRR", "RTTRR") for module in modules_of(code)}
    assert used == set(MODULES)


@given(codes)
def test_any_code_gives_a_possible_robot_that_pinocchio_loads(code: str) -> None:
    text = build_urdf(code)
    model = pin.buildModelFromXML(text)
    assert (model.nq, model.nv) == (len(code), len(code))
    assert model.name == code.lower()
    shapes = {"R": "JointModelR", "T": "JointModelP"}
    assert [joint.shortname()[:-1] for joint in model.joints[1:]] == [shapes[letter] for letter in code]
    assert np.all(model.lowerPositionLimit < 0)
    assert np.all(model.upperPositionLimit > 0)
    for inertia in model.inertias[1:]:
        small, middle, large = np.linalg.eigvalsh(inertia.inertia)
        assert inertia.mass > 0
        assert 0 < small <= middle <= large < small + middle


@pytest.mark.parametrize("code", ["", "rttrr", "RTX", "R T", "RT\n", "ЯТ", None, 5, ("R", "T")])
def test_wrong_codes_are_refused(code: Any) -> None:
    for function in (build_urdf, build_arm, modules_of):
        with pytest.raises(InputError) as caught:
            function(code)
        message = str(caught.value)
        assert repr(code) in message
        assert "wanted one letter per joint" in message
        assert "write it like" in message


def test_the_name_is_the_one_asked_for() -> None:
    assert ET.fromstring(build_urdf("RT", "my-arm_2.1")).get("name") == "my-arm_2.1"
    with pytest.raises(InputError, match="choose another name"):
        build_urdf("RT", 'a"b')
