"""Analysis: checks recorded motions against limits and path, and reduces them to time series."""
