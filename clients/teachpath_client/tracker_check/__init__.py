"""Checks a tracker against the contract of samples: what it published while it showed something is judged by rules."""
