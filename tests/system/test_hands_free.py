"""A client against a recorder over real sockets: takes and verdicts on the terminal, a source of one's own."""

import runpy
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.io.bus import BusSettings, listen_on_bus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration
from teachpath_client.__main__ import main
from teachpath_proto.keys import Keys
from tests.ports import free_ports

pytestmark = pytest.mark.system

EXAMPLE = Path(__file__).parents[2] / "clients" / "examples" / "05_a_source_of_your_own.py"


@pytest.fixture
def endpoint(tmp_path: Path) -> Iterator[str]:
    """Where a recorder listens."""
    (port,) = free_ports(1)
    endpoint = f"tcp/127.0.0.1:{port}"
    bus, store = listen_on_bus(BusSettings(endpoint=endpoint)), Store(StoreSettings(data_dir=str(tmp_path)))
    lookup = Lookup(scene=lambda _: paper_scene(), calibration=Calibration)
    settings = RecordingSettings(longest_silence=60.0, handshake_timeout=20.0)  # of a busy machine
    recorder = Recorder(bus, Keys(), store, settings, lookup)
    queries = RecorderQueries(bus, Keys(), recorder)
    recorder.start()
    queries.start()
    yield endpoint
    queries.stop()
    recorder.stop()
    bus.close()
    store.close()


def test_a_series_of_takes_is_followed_on_the_terminal(endpoint: str, capsys: pytest.CaptureFixture[str]) -> None:
    tracker = ["tracker", "--source", "synthetic", "--endpoint", endpoint, "--speed", "5", "--takes", "2"]
    main([*tracker, "--task", "series", "--scene", "paper"])
    lines = capsys.readouterr().err.splitlines()
    takes = [line for line in lines if line.startswith("  ")]
    assert takes == ["  + take 1 clean", "  + take 2 clean"]
    after = lines[lines.index(takes[0]) + 1]  # the hand may be anywhere in the second take by then
    assert after.startswith("series: recording")
    assert after.endswith("; 1 take, 1 to go")
    # The pause after the last take may be over before the next feedback.
    assert lines[-1] in ("series: paused: pedal, fist or `resume` to go on; 2 takes", "series: ended; 2 takes")


def test_the_example_of_a_source_shows_one_demonstration(
    endpoint: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), "--endpoint", endpoint])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    assert capsys.readouterr().out == "1 demonstrations of 200 samples, 0 lost\n"
