"""Motion: plans a learned path, certifies the plan, and computes the setpoints of its execution."""
