"""The arm: tables of the Puma 560, kinematics, dynamics, geometry, and paths of its joints."""
