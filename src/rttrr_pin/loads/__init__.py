"""What every joint and bearing carries along a trajectory: tables, envelopes, lives of gears."""
