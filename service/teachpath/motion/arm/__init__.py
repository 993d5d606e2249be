"""The arm: tables of the Puma 560, kinematics, dynamics, geometry, and paths of the joints."""
