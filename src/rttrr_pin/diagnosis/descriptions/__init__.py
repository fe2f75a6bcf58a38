"""Two descriptions of one robot: their differences by link and joint, in numbers and in torques."""
