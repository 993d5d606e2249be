"""The motion room: from a learned path to a certified plan, and the arm along it, live."""
