"""From demonstrations to learned paths: clustering, selection of the consistent ones, NURBS fitting."""
