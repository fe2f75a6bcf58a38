"""The robot, and the rooms of its methods."""

from rttrr_pin.robot.robot import Robot as Robot
from rttrr_pin.robot.robot import model_of as model_of
