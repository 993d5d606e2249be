"""The simulated arm, in a process of its own."""
