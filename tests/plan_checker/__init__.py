"""Judges plans and refusals by nothing of what makes them: numbers, chains of matrices and search of its own."""
