"""What lasts: rows of tasks, demonstrations, runs, paths, plans and jobs, and the recordings beside them."""
