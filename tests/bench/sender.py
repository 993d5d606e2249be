"""A tracker client that sends as fast as the bus takes it; a process of its own, told what to do by its arguments."""

import sys
import time
from dataclasses import replace

from teachpath_client import HandReading, Link, Tracker
from teachpath_client.synthetic import RATE, experiment_1
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys

KEYS = Keys("bench")
TRACKER = "glove"
COUNTED_KEY = "bench/counted"  # query of the bare subscriber: answers when it has counted so many


def payloads(count: int) -> list[bytes]:
    """Return `count` hand samples on the wire: the paper's first experiment, over and over."""
    hand = list(experiment_1())
    start_ns = time.time_ns()
    return [_reading(hand, i).message(i + 1, start_ns).SerializeToString() for i in range(count)]


def _reading(hand: list[HandReading], i: int) -> HandReading:
    again, at = divmod(i, len(hand))
    return replace(hand[at], time=hand[at].time + again * len(hand) / RATE)


def send_to_recorder(endpoint: str, count: int) -> float:
    """Send to a recorder and return the seconds from the first sample to the end of the handshake."""
    with Link(endpoint) as link:
        tracker = Tracker(link, TRACKER, prefix=KEYS.prefix)
        tracker.start("bench", scene="paper")
        return _timed(link, KEYS.recorder_stop, count, stop_request(count))


def send_to_subscriber(endpoint: str, count: int) -> float:
    """Send to the bare subscriber and return the seconds from the first sample to its answer."""
    with Link(endpoint) as link:
        return _timed(link, COUNTED_KEY, count, str(count).encode())


def stop_request(count: int) -> bytes:
    """Return the request that ends a recording after `count` samples."""
    return tracker_pb2.StopRecording(tracker=TRACKER, last_sequence=count).SerializeToString()


def _timed(link: Link, key: str, count: int, request: bytes) -> float:
    publisher, samples = link.publisher(KEYS.samples(TRACKER)), payloads(count)
    began = time.perf_counter()
    for payload in samples:
        publisher.put(payload)
    link.ask(key, request, timeout=60.0)
    return time.perf_counter() - began


if __name__ == "__main__":
    to, endpoint, count = sys.argv[1:]
    send = {"recorder": send_to_recorder, "subscriber": send_to_subscriber}[to]
    print(send(endpoint, int(count)))
