"""Teleoperation: the arm follows a tracked hand while its clutch is pressed."""
