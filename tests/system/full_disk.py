"""A recorder whose recordings lie on a disk of 256 KiB that fills up and is mounted read-only: FOLDER.

Run where it may mount, as root or in a name space of its own. Prints one line of JSON: what happened in each part.
"""

import hashlib
import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_sample
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest, RecordingStatus, Sample, StopRequest
from teachpath_proto.keys import Keys
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

KEYS = Keys("disk")
SAMPLE_COUNT = 110
SIZE = "256k"


class Trial:
    """A recorder on the small disk, and one hand."""

    def __init__(self, folder: Path) -> None:
        self.disk = folder / "recordings"
        self.disk.mkdir(parents=True)
        self.mount(f"size={SIZE}")
        self.bus, self.store = MemoryBus(), Store(StoreSettings(data_dir=str(folder)))
        self.now = 0.0  # [s]
        self.recorder = Recorder(
            self.bus,
            KEYS,
            self.store,
            RecordingSettings(),
            Lookup(scene=lambda _: paper_scene(), calibration=Calibration),
            clock=lambda: self.now,
        )
        self.recorder.start()
        self.recorder.begin(RecordingRequest("lift", "glove", scene="paper"))
        self.takes = 0

    def mount(self, options: str) -> None:
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", str(self.disk)], check=True)

    @contextmanager
    def at_rest(self) -> Iterator[None]:
        """Have no file open for a while; a disk that is written to cannot become read-only."""
        self.recorder.pause("glove")
        yield
        self.recorder.resume("glove")

    def show(self) -> dict[str, Any]:
        """Show one more take; say what the station said in the middle of it, and what became of it."""
        x, y, z = paper_scene().carried.position  # type: ignore[union-attr]
        samples = demonstration(1 + self.takes * SAMPLE_COUNT, at=(x, y, z))
        self.takes += 1
        self.send(samples[:60])
        faults = self.recorder.faults()
        self.send(samples[60:])
        self.recorder.wait_for_takes()
        return {"faults": faults, "demonstrations": len(self.status().demonstrations), "files": self.files()}

    def send(self, samples: list[Sample]) -> None:
        for some in (samples[:-1], samples[-1:]):
            for s in some:
                self.bus.publish(KEYS.samples("glove"), encode_sample(s))
            wait_until(lambda some=some: self.statistics().received >= some[-1].sequence, "all is recorded")
            self.now += 1.0  # with the last one a flush is due

    def status(self) -> RecordingStatus:
        (status,) = self.recorder.statuses(with_statistics=True)
        return status

    def statistics(self) -> Any:
        return self.status().statistics

    def files(self) -> dict[str, str]:
        return {f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in self.disk.rglob("*.mcap")}

    def end(self) -> dict[str, Any]:
        statistics: Any = self.recorder.end(StopRequest("glove", self.takes * SAMPLE_COUNT)).statistics
        rows = self.store.demonstrations("lift")
        readable = [len(self.store.recordings.samples(row.recording)) == row.samples for row in rows]
        self.recorder.stop()
        self.store.close()
        return {
            "received": statistics.received,
            "lost": statistics.lost,
            "notes": list(statistics.notes),
            "verdicts": [row.verdict for row in rows],
            "readable": readable,
        }


def main(folder: Path) -> dict[str, Any]:
    trial = Trial(folder)
    told = {"whole": trial.show()}
    filler = trial.disk / "filler"
    with filler.open("wb", buffering=0) as file, suppress(OSError):
        while file.write(bytes(1024)):
            pass
    told["full"] = trial.show()
    filler.unlink()
    told["freed"] = trial.show()
    with trial.at_rest():
        trial.mount("remount,ro")
    told["read-only"] = trial.show()
    trial.mount("remount,rw")
    told["mended"] = trial.show()
    told["end"] = trial.end()
    subprocess.run(["umount", str(trial.disk)], check=True)
    return told


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
