"""Send demonstrations to a teachpath station, and let it learn, plan and move: trackers, replay, and a typed client."""

from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_client.reading import HandReading
from teachpath_client.station import Station
from teachpath_client.tracker import Routine, Tracker

__all__ = ["ClientError", "HandReading", "Link", "Routine", "Station", "Tracker"]
