"""Every hypothesis about a robot: conventions, parameters, joints, mechanics."""
