"""A whole station in this process, without the executor and the simulated arm."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from teachpath.app import Station
from teachpath.commands.serving import free_port
from teachpath.config import Settings, load


def settings(folder: Path) -> Settings:
    """Return the defaults with small limits, data in `folder` and free ports.

    No tracker is lost because the machine was slow: one that is silent is one that waits for its turn.
    """
    return load(
        document={
            "bus": {"endpoint": f"tcp/127.0.0.1:{free_port()}"},
            "store": {"data_dir": str(folder)},
            "recording": {"handshake_timeout": 0.2, "shortest_transport": 8, "longest_silence": 3600.0},
            "web": {"largest_upload": 2_000_000, "hosts": ["robot.example"]},
        }
    )


@contextmanager
def station() -> Iterator[Station]:
    """Open a station whose arm is missing: recorder, jobs and executions run, nobody executes."""
    with tempfile.TemporaryDirectory() as folder, station_in(Path(folder)) as station:
        yield station


@contextmanager
def station_in(folder: Path) -> Iterator[Station]:
    """Open a station without an arm on a data folder."""
    station = Station(settings(folder))
    try:
        parts = (station.recorder, station.executions, station.certificate_status, station.joints, station.jobs)
        for part in parts:
            part.start()
        yield station
    finally:
        station.__exit__(None, None, None)
