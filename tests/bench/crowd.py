"""Many trackers in one process, each with a hand that shows one slow demonstration: ENDPOINT FIRST COUNT SECONDS."""

import math
import sys
import time

from teachpath_client import Link
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys

KEYS = Keys("bench")
RECEIVED_KEY = "bench/received"  # query: its answer comes after all that was put before it
RATE = 50.0  # [Hz]
REACH, RETURN = 0.15, (0.45, 0.85)  # shares of the time at which a hand closes, and the hands open in turn
OPEN_HAND, CLOSED_HAND = [0.1] * 22, [0.9] * 22


def name(number: int) -> str:
    """Return the name of a tracker."""
    return f"glove-{number:03}"


def main(endpoint: str, first: int, count: int, seconds: float) -> int:
    """Send, and return how many samples each tracker has sent."""
    samples = round(seconds * RATE)
    with Link(endpoint) as link:
        hands = [(link.publisher(KEYS.samples(name(first + i))), _opens(i / count)) for i in range(count)]
        messages = {closed: _message(closed) for closed in (False, True)}
        start = time.monotonic() + 0.5
        for i in range(samples):
            share = i / samples
            time.sleep(max(0.0, start + i / RATE - time.monotonic()))
            for message in messages.values():
                message.sequence = i + 1
            for publisher, opens in hands:
                message = messages[REACH < share < opens]
                message.position.y = 0.3 * math.sin(2.0 * math.pi * min(share, opens))
                message.device_ns = time.time_ns()
                publisher.put(message.SerializeToString())
        link.ask(RECEIVED_KEY, timeout=120.0)  # Zenoh loses what a session that closes still has under way
    return samples


def _opens(turn: float) -> float:
    return RETURN[0] + turn * (RETURN[1] - RETURN[0])


def _message(closed: bool) -> tracker_pb2.HandSample:
    message = tracker_pb2.HandSample(tracked=True, flexions=CLOSED_HAND if closed else OPEN_HAND)
    message.orientation.w = 1.0
    message.position.x, message.position.z = 0.5, 0.6
    return message


if __name__ == "__main__":
    print(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])))
