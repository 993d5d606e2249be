"""Selection: the consistent demonstrations of a cluster."""
