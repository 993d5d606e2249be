"""From a stream of hand samples to a demonstration: accounts, phases, the object's trajectory, the verdict. Pure."""
