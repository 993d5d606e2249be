"""Collision: distances between arm, load and scene, at configurations and on the whole motion between them."""
