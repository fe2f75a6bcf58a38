"""The mechanics, over scalars of any kind: algebra, joints, bodies, the recursion, and the robot as data."""
