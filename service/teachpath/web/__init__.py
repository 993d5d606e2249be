"""The web port: its settings, and the server behind it."""
