"""Driving forces and joint loads of the RTTRR arm, for one state and for a whole motion."""

from __future__ import annotations

import numpy as np

import rttrr_pin
from rttrr_pin import Wrench

robot = rttrr_pin.load("rttrr")

# One state, by joint name [rad, m]; a 2 kg load in the gripper presses on the tool's surroundings with its weight,
# upwards, so the payload is given in base axes.
state = {"joint_1": 0.3, "joint_2": 0.05, "joint_3": 0.1, "joint_4": -0.4, "joint_5": 0.2}
at_rest = dict.fromkeys(state, 0.0)
load = Wrench(force=(0, 0, 2 * 9.81), expressed_in="base")
result = robot.inverse_dynamics(state, at_rest, at_rest, payload=load)
for joint, tau in zip(robot.joint_names, result.tau, strict=True):
    print(f"{joint}: {tau:8.3f}")

# A motion: time on the first axis, joints on the last.
t = np.linspace(0, 2, 201)[:, None]
phase = np.arange(5)
q = 0.1 * np.sin(2 * t + phase)
v = 0.2 * np.cos(2 * t + phase)
a = -0.4 * np.sin(2 * t + phase)
motion = robot.inverse_dynamics(q, v, a, payload=load)

# What the bearing of joint 4 carries: f and n that link 3 exerts on link 4, in the frame of link 4.
bearing = motion.at("link_4")
print(f"joint 4 carries at most {np.linalg.norm(bearing['f'], axis=-1).max():.1f} N", end=" and ")
print(f"{np.linalg.norm(bearing['n'], axis=-1).max():.2f} N m")
