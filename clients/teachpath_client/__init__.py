"""Send demonstrations to a teachpath station: tracker clients, replay and the paper's synthetic experiments."""

from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_client.reading import HandReading
from teachpath_client.tracker import Routine, Tracker

__all__ = ["ClientError", "HandReading", "Link", "Routine", "Tracker"]
