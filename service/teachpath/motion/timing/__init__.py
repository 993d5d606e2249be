"""Timing: the fastest motion along a path within the limits of the joints."""
