"""Inverse dynamics as a newcomer writes them, without one term: how far do they get? `rttrr-pin conform` says which."""

import numpy as np

from rttrr_pin.conformance import conform


def skew(r):
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def my_id(model):
    """Of a robot, a function of q, v, a; joints that turn, slide or are fixed."""
    if model.floating or any(joint.mimic for joint in model.joints):
        raise NotImplementedError("no floating base, no joint that follows another")

    def tau(q, v, a):
        q, v, a = iter(q), iter(v), iter(a)
        w, w_dot, v_dot, on_links, placed, own = [], [], [], [], [], []
        for joint, link in zip(model.joints, model.links, strict=True):
            rest = (np.zeros(3), np.zeros(3), -model.gravity)
            w_p, w_dot_p, v_dot_p = rest if joint.parent < 0 else (x[joint.parent] for x in (w, w_dot, v_dot))
            R, p, z = joint.R, joint.p, joint.axis
            q_i, v_i, a_i = (next(q), next(v), next(a)) if joint.nv else (0.0, 0.0, 0.0)
            turns = str(joint.type) in ("revolute", "continuous")
            if turns:
                R = R @ (np.eye(3) + np.sin(q_i) * skew(z) + (1 - np.cos(q_i)) * skew(z) @ skew(z))
            else:
                p = p + R @ z * q_i
            w_i, w_dot_i = R.T @ w_p, R.T @ w_dot_p
            v_dot_i = R.T @ (v_dot_p + np.cross(w_dot_p, p) + np.cross(w_p, np.cross(w_p, p)))
            if turns:
                w_dot_i = w_dot_i + np.cross(w_i, z * v_i) + z * a_i
                w_i = w_i + z * v_i
            else:
                v_dot_i = v_dot_i + 2 * np.cross(w_i, z * v_i) + z * a_i
            F = link.mass * (v_dot_i + np.cross(w_dot_i, link.com) + np.cross(w_i, np.cross(w_i, link.com)))
            N = link.inertia @ w_dot_i  # and w x I w
            for values, value in zip((w, w_dot, v_dot), (w_i, w_dot_i, v_dot_i), strict=True):
                values.append(value)
            on_links.append([F, N + np.cross(link.com, F)])
            placed.append((R, p))
            e = joint.effects
            own.append((turns, e.armature * a_i + e.damping * v_i + e.friction * np.sign(v_i)))
        result = []
        steps = list(zip(model.joints, on_links, placed, own, strict=True))
        for joint, (f, n), (R, p), (turns, drive) in reversed(steps):
            if joint.parent >= 0:
                below = on_links[joint.parent]
                below[0], below[1] = below[0] + R @ f, below[1] + R @ n + np.cross(p, R @ f)
            if joint.nv:
                result.append(joint.axis @ (n if turns else f) + drive)
        return np.array(result[::-1])

    return tau


if __name__ == "__main__":
    print(conform(my_id, levels=["gravity", "rates", "payload", "mimic"], n_states=8).summary())
