"""Clustering: demonstrations grouped by the distance of their paths."""
