"""Work on the data folder itself: importing files and repairing what a crash left."""
