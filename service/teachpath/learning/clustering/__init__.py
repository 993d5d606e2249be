"""Clustering: the different ways of doing a task."""
