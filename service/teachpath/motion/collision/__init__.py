"""Collision: the distance between arm, load and scene, at samples and between them."""
