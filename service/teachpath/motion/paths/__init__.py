"""Paths: the tool's poses along a curve, and the branches of inverse kinematics that reach them."""
