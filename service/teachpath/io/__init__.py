"""The way out: bus, wire, store and files."""
