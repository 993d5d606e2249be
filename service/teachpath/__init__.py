"""Teach a robot a path by showing it: the programming-by-demonstration service."""

__version__ = "0.1.0"
