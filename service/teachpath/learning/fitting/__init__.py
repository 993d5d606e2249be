"""Fitting: the NURBS and the orientations that follow the selected demonstrations."""
