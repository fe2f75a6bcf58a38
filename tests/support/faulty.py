"""A file, and what can be wrong with it: cases of every kind of fault that the reader knows."""

from __future__ import annotations

import math

INERTIA = '<inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.2" iyz="0.03" izz="0.15"/>'
LIMIT = '<limit lower="-1" upper="1" velocity="2" effort="3"/>'
URDF = f"""<?xml version="1.0"?>
<robot name="two">
<link name="base"/>
<link name="arm">
  <inertial>
    <origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>
    <mass value="1.5"/>
    {INERTIA}
  </inertial>
</link>
<link name="hand"/>
<link name="finger"><inertial><mass value="0.5"/>{INERTIA}</inertial></link>
<joint name="turn" type="revolute">
  <parent link="base"/><child link="arm"/>
  <origin xyz="0 0 0.5"/>
  <axis xyz="0 0 2"/>
  {LIMIT}
</joint>
<joint name="grip" type="fixed"><parent link="arm"/><child link="hand"/></joint>
<joint name="move" type="prismatic">
  <parent link="hand"/><child link="finger"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>{LIMIT}
</joint>
</robot>
"""
START = '<?xml version="1.0"?>\n'
HAND = '<link name="hand"/>'
GRIP = '<parent link="arm"/><child link="hand"/>'

NOTES: dict[str, tuple[str, str, str]] = {
    # id: (what stands in the file, what it becomes, the kind of the fault); no number depends on it
    "version-0": ('version="1.0"', 'version="0.0" ', "declaration"),
    "version-1": ('version="1.0"', 'version="1" ', "declaration"),
    "no-version": ('<?xml version="1.0"?>', "<?xml?>", "declaration"),
    "late-declaration": (START, "\n" + START, "declaration"),
    "behind-a-comment": (START, "<!-- a robot -->" + START, "declaration"),
    "two-declarations": (START, START + START, "declaration"),
    "hyphens": (START, START + "<!-- a -- b -->", "comment"),
    "second-robot": ("</robot>", '</robot><robot name="other"><link name="x"/></robot>', "behind"),
    "stray-text": (HAND, HAND + "oops", "text"),
    "end-of-a-comment": ('<mass value="1.5"/>', '<mass value="1.5"/> -->', "text"),
    "text-in-a-joint": (GRIP, GRIP + "+", "text"),
    "text-beside-a-value": ('<mass value="1.5"/>', '<mass value="1.5">2</mass>', "text"),
    "default-namespace": ('<robot name="two">', '<robot name="two" xmlns="http://drake.mit.edu">', "namespace"),
    "namespace-of-a-link": (HAND, '<link xmlns="urn:x" name="hand"/>', "namespace"),
    "undeclared-prefix": (HAND, HAND + "<gazebo><sensor:camera a:b='1'/></gazebo>", "namespace"),
    "xacro-property": (HAND, HAND + '<xacro:property name="width" value=".2"/>', "xacro"),
    "xacro-macro": (HAND, HAND + '<xacro:macro name="m"><link name="x"><inertial/></link></xacro:macro>', "xacro"),
    "xacro-arg": ("</robot>", '<x:arg xmlns:x="http://www.ros.org/wiki/xacro" name="a"/></robot>', "xacro"),
    "xacro-in-a-drawing": (
        HAND,
        '<link name="hand"><visual><geometry><box size="1 1 1"/></geometry><xacro:grey/></visual></link>',
        "xacro",
    ),
    "axis-rpy": ('<axis xyz="0 0 2"/>', '<axis xyz="0 0 2" rpy="0 0 0"/>', "word"),
    "axis-of-a-fixed-joint": (GRIP, GRIP + '<axis xzy="0 0 1"/>', "word"),
    "friction-in-an-inertial": ('<mass value="1.5"/>', '<mass value="1.5"/><friction value="1"/>', "word"),
    "mass-beside-an-inertial": ("</inertial>", "</inertial><mass>1.5</mass>", "word"),
    "inertial-in-the-robot": (HAND, HAND + f'<inertial><mass value="3"/>{INERTIA}</inertial>', "word"),
    "k-velocity": ('velocity="2"', 'velocity="2" k_velocity="1"', "word"),
    "beside-xyz-and-rpy": ('rpy="0 0 0"/>', 'rpy="0 0 0" rrpy="1 0 0"/>', "word"),
    "nine-entries": ('iyy="0.2"', 'iyx="0.010" izx="2e-2" izy="0.03" iyy="0.2"', "products"),
    "same-origin-twice": ('<origin xyz="0 0 0.5"/>', '<origin xyz="0 0 0.5"/><origin xyz="0 0 0.5"/>', "twice"),
    "same-axis-apart": ('<parent link="base"/>', '<axis xyz="0 0 2"/><parent link="base"/>', "twice"),
    "axes-of-a-fixed-joint": (GRIP, GRIP + '<axis xyz="0 0 1"/><axis xyz="0 1 0"/>', "twice"),
    "number-of-a-fixed-axis": (GRIP, GRIP + '<axis xyz="0 0 1kg"/>', "unused"),
    "number-of-a-fixed-limit": (GRIP, GRIP + '<limit effort="1,5"/>', "unused"),
    "no-robot-name": ('<robot name="two">', "<robot>", "unnamed"),
    "empty-robot-name": ('<robot name="two">', '<robot name="">', "name"),
    "loop-joint": (
        HAND,
        HAND + '<loop_joint name="c"><link1 link="arm"/><link2 link="base"/></loop_joint>',
        "not-modelled",
    ),
    "constraint": (HAND, HAND + '<closure name="c"><parent link="arm"/><child link="base"/></closure>', "not-modelled"),
    "spring": (GRIP, GRIP + '<torsional_spring k="3"/>', "not-modelled"),
    "dangling-transmission": (
        HAND,
        HAND + '<transmission name="t"><joint name="gone"/></transmission>',
        "transmission",
    ),
    "shared-actuator": (
        HAND,
        HAND + '<transmission name="t"><joint name="turn"/><actuator name="m"/></transmission>' * 2,
        "transmission",
    ),
    "materials": (HAND, HAND + '<material name="m"/><material name="m"/>', "material"),
    "empty-dynamics": ('<axis xyz="0 0 2"/>', '<axis xyz="0 0 2"/><dynamics/>', "asked"),
    "safety": ('<axis xyz="0 0 2"/>', '<axis xyz="0 0 2"/><safety_controller soft_lower_limit="0"/>', "asked"),
}

AXIS = '<axis xyz="0 0 2"/>'
ASSUMPTIONS: dict[str, tuple[str, str, str, str]] = {
    # id: (what stands in the file, what it becomes, the kind of the fault, what is read in its place)
    "no-axis": (AXIS, "", "axis", '<axis xyz="1 0 0"/>'),
    "axis-xzy": (AXIS, '<axis xzy="0 0 1"/>', "word", '<axis xyz="1 0 0"/>'),
    "zero-axis": (AXIS, '<axis xyz="0 0 0"/>', "direction", '<axis xyz="1 0 0"/>'),
    "unequal-axes": (AXIS, AXIS + '<axis xyz="0 1 0"/>', "twice", AXIS),
    "axis-number": (AXIS, '<axis xyz="0 0 1m"/>', "number", '<axis xyz="1 0 0"/>'),
    "reversed": ('lower="-1" upper="1"', 'lower="3" upper="-2"', "range", 'lower="-2" upper="3"'),
    "above-the-default": ('lower="-1" upper="1"', 'lower="0.5"', "range", 'lower="0" upper="0.5"'),
    "dangling-mimic": (AXIS, AXIS + '<mimic joint="gone"/>', "mimic", AXIS),
    "mimic-of-nothing": (AXIS, AXIS + "<mimic/>", "mimic", AXIS),
    "mimic-itself": (AXIS, AXIS + '<mimic joint="turn"/>', "mimic", AXIS),
    "mimic-of-fixed": (AXIS, AXIS + '<mimic joint="grip"/>', "mimic", AXIS),
    "no-mass": ('<mass value="1.5"/>', "", "mass", ""),
    "mass-unit": ('<mass value="1.5"/>', '<mass value="1.5kg"/>', "mass", ""),
    "density": ('<mass value="1.5"/>', '<density value="400"/>', "word", ""),
    "no-inertia": (INERTIA, "", "inertia", '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'),
    "no-products": (
        INERTIA,
        '<inertia ixx="0.1" iyy="0.2" izz="0.15"/>',
        "inertia",
        '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/>',
    ),
    "entry": ('ixy="0.01"', 'ixy="0,01"', "number", 'ixy="0"'),
    "other-product": ('iyy="0.2"', 'iyx="-0.01" iyy="0.2"', "products", 'iyy="0.2"'),
    "alone": ('ixy="0.01"', 'iyx="0.01"', "products", 'ixy="0"'),
    "misspelt-rpy": ('<origin xyz="0 0 0.5"/>', '<origin xyz="0 0 0.5" rrpy="1 0 0"/>', "word", '<origin xyz="0 0 0.5"/>'),
    "origin-number": ('<origin xyz="0 0 0.5"/>', '<origin xyz="0 0 a"/>', "number", '<origin xyz="0 0 0"/>'),
    "unequal-inertials": (
        "</inertial>",
        f'</inertial><inertial><mass value="0.009"/>{INERTIA}</inertial>',
        "twice",
        "</inertial>",
    ),
    "xacro-call": (HAND, HAND + "<xacro:gripper/>", "xacro", HAND),
    "mass-as-text": ('<mass value="1.5"/>', "<mass>1.5</mass>", "text", ""),
    "negative-velocity": ('velocity="2"', 'velocity="-2"', "limit", 'velocity="1e9"'),
    "negative-damping": (AXIS, AXIS + '<dynamics damping="-1"/>', "dynamics", AXIS + '<dynamics damping="0"/>'),
    "version": ('<robot name="two">', '<robot name="two" version="7.0">', "version", '<robot name="two">'),
    "quaternion": (
        '<origin xyz="0 0 0.5"/>',
        '<origin xyz="0 0 0.5" quat_xyzw="1 0 0 0"/>',
        "quaternion",
        f'<origin xyz="0 0 0.5" rpy="{math.pi!r} 0 0"/>',
    ),
    "two-parents": (
        "</robot>",
        '<joint name="z" type="fixed"><parent link="base"/><child link="hand"/></joint></robot>',
        "tree",
        "</robot>",
    ),
}  # fmt: skip

ERRORS: dict[str, tuple[str, str, str]] = {
    # id: (what stands in the file, what it becomes, the kind of the fault); there is no robot
    "type": ('type="revolute"', 'type="spherical"', "joint"),
    "no-type": ('type="revolute"', "", "joint"),
    "no-parent": ('<parent link="base"/>', "", "joint"),
    "unknown-child": ('<child link="hand"/>', '<child link="hond"/>', "joint"),
    "two-roots": (HAND, HAND + '<link name="other"/>', "tree"),
    "loop": ('<parent link="base"/>', '<parent link="finger"/>', "loop"),
    "ring": (
        "</robot>",
        '<joint name="z" type="fixed"><parent link="finger"/><child link="base"/></joint></robot>',
        "loop",
    ),
    "same-link": (HAND, HAND + '<link name="arm"/>', "name"),
    "no-name": (HAND, HAND + "<link/>", "name"),
}


def changed(old: str, new: str) -> str:
    """The file with one part of it exchanged."""
    assert old in URDF
    return URDF.replace(old, new, 1)
