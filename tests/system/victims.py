"""Recorders that are killed while they record: `python -m tests.system.victims FOLDER COUNT SEED`.

Prints one line of JSON a victim: its data folder, when it was killed, and [number, when] of every sample that it was
sent; times are seconds of one monotonic clock.
"""

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_sample
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.recorder.recorder import Lookup, Recorder
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest
from teachpath_proto.keys import Keys
from tests.unit.recording.hands import demonstration

TOGETHER = 10  # victims that live at one time
RATE = 100.0  # [Hz] that a victim is sent
LIVES = (0.2, 3.2)  # [s]
KEYS = Keys("victims")


def record(folder: Path, sent: int) -> None:
    """Record for ever, telling on the pipe `sent` what was sent before it is sent."""
    bus, store = MemoryBus(), Store(StoreSettings(data_dir=str(folder)))
    lookup = Lookup(scene=lambda _: paper_scene(), calibration=Calibration)
    recorder = Recorder(bus, KEYS, store, RecordingSettings(), lookup)
    recorder.start()
    recorder.begin(RecordingRequest("lift", "glove", scene="paper"))
    x, y, z = paper_scene().carried.position  # type: ignore[union-attr]
    first, due = 1, time.monotonic()
    while True:
        for sample in demonstration(first, at=(x, y, z)):
            due += 1.0 / RATE
            time.sleep(max(0.0, due - time.monotonic()))
            payload = encode_sample(sample)
            now = time.monotonic()
            bus.publish(KEYS.samples("glove"), payload)
            os.write(sent, f"{sample.sequence} {now}\n".encode())
        first += 110


def kill_some(root: Path, lives: list[float], first: int) -> None:
    """Start a recorder for each life [s], and kill it when that is over."""
    victims = []
    for number in range(first, first + len(lives)):
        told, sent = os.pipe()
        pid = os.fork()
        if pid == 0:
            try:
                record(root / f"{number:02}", sent)
            finally:
                os._exit(1)
        os.close(sent)
        victims.append((pid, root / f"{number:02}", os.fdopen(told)))
    began = [(stream.readline(), time.monotonic()) for _, _, stream in victims]
    for life, (pid, folder, stream), (line, start) in sorted(
        zip(lives, victims, began, strict=True), key=lambda v: v[0]
    ):
        time.sleep(max(0.0, start + life - time.monotonic()))
        killed = time.monotonic()
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        lines = [line, *stream]
        told_of = [each.split() for each in lines if each.endswith("\n")]
        print(json.dumps({"data": str(folder), "killed": killed, "sent": [(int(n), float(t)) for n, t in told_of]}))


if __name__ == "__main__":
    root, count, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    chance = random.Random(seed)
    for begin in range(0, count, TOGETHER):
        kill_some(root, [chance.uniform(*LIVES) for _ in range(min(TOGETHER, count - begin))], begin)
