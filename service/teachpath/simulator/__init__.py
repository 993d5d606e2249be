"""The simulated arm: a dynamic Puma 560 that plays the setpoints."""
