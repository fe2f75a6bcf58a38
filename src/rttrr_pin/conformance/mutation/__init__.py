"""How many wrong dynamics a suite of tests would let pass, and which."""
