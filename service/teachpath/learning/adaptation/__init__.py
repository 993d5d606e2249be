"""Learned paths for objects that lie elsewhere: kriging of the shown shapes, and the adaptation of a path."""
