"""The service's side of the robot: executions, their recordings, joint states, and the processes beside it."""
