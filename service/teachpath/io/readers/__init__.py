"""Readers of recordings that other programs wrote; each is a member of the entry-point group `teachpath.readers`."""
