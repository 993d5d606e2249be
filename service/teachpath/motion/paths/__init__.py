"""Paths: the tool's poses along a curve, and the arm's configurations for them."""
