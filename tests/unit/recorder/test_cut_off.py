"""What health calls cut off: files that nobody writes any more, never a take that has ended and is being completed."""

import io
import threading
from pathlib import Path

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration
from tests.waiting import HANG, wait_until


class HeldFile(io.BufferedWriter):
    """A file that is not finished before the test says so."""

    def __init__(self, path: Path, released: threading.Event) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        super().__init__(io.FileIO(path, "xb"))
        self._released = released

    def fileno(self) -> int:
        """Wait, because a file is forced to the disk by its number when it is finished."""
        assert self._released.wait(HANG)
        return super().fileno()


def test_a_take_that_is_completed_after_a_stop_is_not_cut_off_and_a_file_that_nobody_writes_is(tmp_path: Path) -> None:
    released = threading.Event()
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")), opener=lambda path: HeldFile(path, released))
    bench = Bench(store)
    recorder, recordings, shown = bench.recorder, store.recordings, demonstration()
    bench.begin()
    bench.send(shown)
    ending = threading.Thread(target=bench.end, args=(len(shown),))
    ending.start()
    wait_until(lambda: not recorder.statuses(), "the recording has ended")
    (part,) = recordings.unfinished()
    assert recordings.cut_off(recorder.is_writing) == []
    released.set()
    ending.join()
    assert not recorder.is_writing()
    assert recordings.unfinished() == []
    part.touch()
    assert recordings.cut_off(recorder.is_writing) == [part]
    bench.begin()
    assert recordings.cut_off(recorder.is_writing) == []
    recorder.stop()
    store.close()
