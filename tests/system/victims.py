"""Recorders that are killed while they record: `python -m tests.system.victims FOLDER COUNT SEED`.

Prints one line of JSON a victim: its data folder, and [number, when] of every sample that it had recorded, and told of,
when it was killed. Times are seconds of the victim's own clock, which goes on with every sample and with nothing else.
"""

import json
import os
import random
import signal
import sys
from pathlib import Path

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_sample
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest
from teachpath_proto.keys import Keys
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

PARALLEL_VICTIMS = 10  # victims that live at one time
RATE = 100.0  # [Hz] that a victim is sent
BATCH = 5  # samples that are sent at a time
LIVES = (20, 320)  # samples
KEYS = Keys("victims")


def record(folder: Path, told: int) -> None:
    """Record for ever, telling on the pipe `told` of what is recorded."""
    now = 0.0
    bus, store = MemoryBus(), Store(StoreSettings(data_dir=str(folder)))
    lookup = Lookup(scene=lambda _: paper_scene(), calibration=Calibration)
    recorder = Recorder(bus, KEYS, store, RecordingSettings(), lookup, clock=lambda: now)
    recorder.start()
    recorder.begin(RecordingRequest("lift", "glove", scene="paper"))
    x, y, z = paper_scene().carried.position  # type: ignore[union-attr]
    sent = 0
    while True:
        for sample in demonstration(1 + sent, at=(x, y, z)):
            now += 1.0 / RATE
            bus.publish(KEYS.samples("glove"), encode_sample(sample))
            sent = sample.sequence
            if sent % BATCH == 0:
                wait_until(lambda sent=sent: received(recorder) == sent, "all is recorded")
                os.write(told, b"".join(f"{sent - i} {now - i / RATE}\n".encode() for i in reversed(range(BATCH))))


def received(recorder: Recorder) -> int:
    (status,) = recorder.statuses(with_statistics=True)
    return status.statistics.received if status.statistics is not None else 0


def kill_some(root: Path, lives: list[int], first: int) -> None:
    """Start a recorder for each life [samples], and kill it when it has told of so many, or of some more."""
    victims = []
    for number, life in enumerate(lives, first):
        told, telling = os.pipe()
        pid = os.fork()
        if pid == 0:
            try:
                record(root / f"{number:02}", telling)
            finally:
                os._exit(1)
        os.close(telling)
        victims.append((life, pid, root / f"{number:02}", os.fdopen(told)))
    for life, pid, folder, stream in sorted(victims, key=lambda victim: victim[0]):
        lines = [stream.readline() for _ in range(life)]
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        told_of = [each.split() for each in [*lines, *stream] if each.endswith("\n")]
        print(json.dumps({"data": str(folder), "recorded": [(int(n), float(t)) for n, t in told_of]}))


if __name__ == "__main__":
    root, count, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    chance = random.Random(seed)
    for begin in range(0, count, PARALLEL_VICTIMS):
        kill_some(root, [chance.randint(*LIVES) for _ in range(min(PARALLEL_VICTIMS, count - begin))], begin)
