"""The executor: streams the setpoints of one plan at a time to the arm, in a process of its own."""
