"""From a stream of hand samples to a demonstration: statistics, phases, trajectory and quality. Pure."""
