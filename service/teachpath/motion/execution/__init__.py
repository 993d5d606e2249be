"""Execution: what a plan or a live hand asks of the arm, cycle by cycle."""
