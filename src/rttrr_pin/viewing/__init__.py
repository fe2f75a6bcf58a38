"""A robot in the browser: frames, bodies, forces, along a trajectory."""
