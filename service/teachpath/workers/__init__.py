"""The running things: recorder, jobs, executor, simulator, preview; strangers to each other."""
