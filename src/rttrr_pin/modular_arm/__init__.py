"""The bundled arms, built from modules: a code such as "RTTRR" in, URDF text out.

`python docs/arms.py urdf` writes urdf/*.urdf, and the tables in urdf/README.md where that file is.
Of the RTTRR arm, the paper (Detesan) gives the structure and which lengths exist; every number is ours.

A joint's module has two halves: the *stator*, which belongs to the link before the joint, and the *mover*, which
belongs to the link behind it. A mover carries the next stator on its port, so

    origin of joint k+1 in {k} = exit of the mover of joint k + entry of the stator of joint k+1.

All frames are parallel at q = 0. Parts of both halves are placed in the frame at the joint's origin, at q = 0.

| joint | axis |
|---|---|
| T, the first, third, ... T of the code | z |
| T, the second, fourth, ... T of the code | y |
| R, the first, third, ... of an unbroken run of R | z |
| R, the second, fourth, ... of an unbroken run of R | y |

RTTRR has z, z, y, z, y. The R that end the code, two at most and never the first joint, are of wrist size.
"""

from __future__ import annotations

from rttrr_pin.modular_arm.build import Arm, build_arm, build_urdf, modules_of
from rttrr_pin.modular_arm.modules import CODES, MATERIALS, MODULES, Module

__all__ = ["CODES", "MATERIALS", "MODULES", "Arm", "Module", "build_arm", "build_urdf", "modules_of"]
