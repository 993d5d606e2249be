"""The simulated arm: a dynamic arm that plays the setpoints."""
