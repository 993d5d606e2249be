"""The executor: runs a certified plan, or follows a live hand, setpoint by setpoint."""
