"""Tells whether inverse dynamics are right, and if not, which link and which quantity is wrong.

>>> import rttrr_pin
>>> robot = rttrr_pin.load("rttrr")
>>> tau = robot.inverse_dynamics(q=[0, 0, 0, 0, 0], v=[0, 0, 0, 0, 0], a=[0, 0, 0, 0, 0]).tau

PYTEST_DONT_REWRITE: it has no assertions, and pytest, which loads our plugin, would warn where it is loaded before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy
from rttrr_pin.version import __version__ as __version__

if TYPE_CHECKING:
    from rttrr_pin.auditing import audit as audit
    from rttrr_pin.auditing import read_publication as read_publication
    from rttrr_pin.compile import Kernel as Kernel
    from rttrr_pin.compile.device import DeviceKernel as DeviceKernel
    from rttrr_pin.conformance import conform as conform
    from rttrr_pin.core.conventions import Convention as Convention
    from rttrr_pin.core.identification import BaseParameters as BaseParameters
    from rttrr_pin.core.joint import Joint as Joint
    from rttrr_pin.core.joint import JointEffects as JointEffects
    from rttrr_pin.core.joint import Limits as Limits
    from rttrr_pin.core.joint import Mimic as Mimic
    from rttrr_pin.core.joint_wrenches import JointWrenches as JointWrenches
    from rttrr_pin.core.model import Link as Link
    from rttrr_pin.core.model import Model as Model
    from rttrr_pin.core.payload import RandomPayload as RandomPayload
    from rttrr_pin.core.statics import WrenchEstimate as WrenchEstimate
    from rttrr_pin.core.wrench import LinkWrenches as LinkWrenches
    from rttrr_pin.core.wrench import Wrench as Wrench
    from rttrr_pin.derivation import derive as derive
    from rttrr_pin.diagnosis import compare_robots as compare_robots
    from rttrr_pin.diagnosis import diagnose as diagnose
    from rttrr_pin.diagnosis import sample_states as sample_states
    from rttrr_pin.errors import InputError as InputError
    from rttrr_pin.errors import RttrrError as RttrrError
    from rttrr_pin.exact import Enclosures as Enclosures
    from rttrr_pin.implementations import Batch as Batch
    from rttrr_pin.implementations import Evaluation as Evaluation
    from rttrr_pin.implementations import Implementation as Implementation
    from rttrr_pin.inspection import inspect as inspect
    from rttrr_pin.laws import check_laws as check_laws
    from rttrr_pin.loading import load as load
    from rttrr_pin.loading import load_all as load_all
    from rttrr_pin.loads import LoadReport as LoadReport
    from rttrr_pin.loads import compute_loads as compute_loads
    from rttrr_pin.robot import Robot as Robot
    from rttrr_pin.trajectories import Trajectory as Trajectory
    from rttrr_pin.trajectories import pick_and_place as pick_and_place
    from rttrr_pin.trajectories import read_trajectory as read_trajectory
    from rttrr_pin.trajectories import rest_to_rest as rest_to_rest
    from rttrr_pin.validation import compare_state as compare_state
    from rttrr_pin.validation import validate as validate
    from rttrr_pin.validation import validate_many as validate_many
    from rttrr_pin.validation.search import search_worst_state as search_worst_state

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "auditing": ("audit", "read_publication"),
        "compile": ("Kernel",),
        "compile.device": ("DeviceKernel",),
        "conformance": ("conform",),
        "core.conventions": ("Convention",),
        "core.identification": ("BaseParameters",),
        "core.joint": ("Joint", "JointEffects", "Limits", "Mimic"),
        "core.joint_wrenches": ("JointWrenches",),
        "core.model": ("Link", "Model"),
        "core.payload": ("RandomPayload",),
        "core.statics": ("WrenchEstimate",),
        "core.wrench": ("LinkWrenches", "Wrench"),
        "derivation": ("derive",),
        "diagnosis": ("compare_robots", "diagnose", "sample_states"),
        "errors": ("InputError", "RttrrError"),
        "exact": ("Enclosures",),
        "implementations": ("Batch", "Evaluation", "Implementation"),
        "inspection": ("inspect",),
        "laws": ("check_laws",),
        "loading": ("load", "load_all"),
        "loads": ("LoadReport", "compute_loads"),
        "robot": ("Robot",),
        "trajectories": ("Trajectory", "pick_and_place", "read_trajectory", "rest_to_rest"),
        "validation": ("compare_state", "validate", "validate_many"),
        "validation.search": ("search_worst_state",),
    },
)
__all__ += ["__version__"]
