"""Analysis: a recorded motion, checked against its limits and drawn over time."""
