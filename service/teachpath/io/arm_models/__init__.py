"""Arms from models in URDF and MJCF: the chain of joints, limits, inertia and solids."""
