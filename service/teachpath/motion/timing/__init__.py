"""Timing: the fastest motions along paths, within the limits of the joints."""
