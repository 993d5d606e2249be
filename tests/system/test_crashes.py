"""A service that is killed: what is on the disk afterwards, and what the next service makes of it."""

import hashlib
import itertools
import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.io.store.salvage import salvage
from teachpath_client import HandReading, Link, Tracker
from teachpath_client.synthetic import experiment_1
from tests.system.processes import Service, run
from tests.system.test_station import record, trajectory
from tests.waiting import wait_until

pytestmark = pytest.mark.system


def fingerprints(data: Path) -> dict[str, str]:
    return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in data.rglob("*.mcap")}


def on_disk(data: Path) -> int:
    """How many samples are in the files that are being written."""
    return sum(len(salvage(part)[1]) for part in data.rglob("*.part"))


def cut_short(count: int) -> Iterator[HandReading]:
    """Yield the first demonstration and so many more readings."""
    return itertools.islice(experiment_1(), count)


def test_a_kill_in_mid_take_costs_only_what_was_not_yet_flushed(tmp_path: Path) -> None:
    sent = 220  # in mid-transport
    with Service(tmp_path / "data") as killed:
        record(killed, "carry", 1)
        before, files = killed.station.demonstrations("carry"), fingerprints(killed.data)
        with Link(killed.endpoint) as link:
            tracker = Tracker(link, "glove")
            tracker.start("carry")
            tracker.publish(cut_short(sent), speed=1.0)
            wait_until(lambda: on_disk(killed.data) == sent, "all is on the disk, though the take goes on")
            killed.kill()
        killed.wait_gone()

    doctor = run("doctor", "--data", str(killed.data), folder=tmp_path)
    assert doctor.process.returncode == 0, doctor.err
    found = re.search(r"(\d+) samples .* are whole, at most the last second is missing; made (demo-\w+)", doctor.out)
    assert found is not None, doctor.out
    assert int(found[1]) == sent
    assert fingerprints(killed.data).items() >= files.items()
    assert "every recording is whole" in run("doctor", "--data", str(killed.data), folder=tmp_path).out

    with Service(killed.data) as next_one:
        earlier, made = next_one.station.demonstrations("carry")
        assert [earlier] == before
        assert made.id == found[2]
        assert made.samples == int(found[1])
        assert made.verdict == "reject"
        assert any("cut off" in note for note in made.statistics.notes)
        assert len(trajectory(next_one, made.id)[0]) == made.release - made.grasp
        assert next_one.station.health().notes == []
        assert len(record(next_one, "carry", 1).demonstrations) == 1


def test_a_job_under_way_is_run_again_once(tmp_path: Path) -> None:
    with Service(tmp_path / "data") as killed:
        assert len(record(killed, "carry", 12).demonstrations) == 12
        parts = lambda: {*killed.find("[executor]"), *killed.find("[simulator]")}  # noqa: E731
        lanes = lambda: len(found := {*killed.find("forkserver")} - parts()) > 2 and found  # noqa: E731
        wait_until(lambda: len(parts()) == 2, "executor and simulated arm are there")
        workers = wait_until(lanes, "the processes of both lanes are there, beside the one they are forked from")
        for worker in workers:
            os.kill(worker, signal.SIGSTOP)  # so that the job cannot end before the kill
        job = killed.station.begin_job("carry", "learn")
        running = lambda: killed.station.get_job(job.id).state == "running"  # noqa: E731
        wait_until(running, "the job runs")
        killed.kill()
        for worker in workers:
            os.kill(worker, signal.SIGCONT)
        killed.wait_gone()

    with Service(killed.data) as next_one:
        ended = next_one.station.wait(next_one.station.get_job(job.id))
        assert (ended.state, ended.attempt) == ("succeeded", 1), ended.message
        (only,) = next_one.station.runs("carry")
        assert only.id == ended.outcome
        assert len(next_one.station.jobs("carry")) == 1
        assert only.demonstrations == 12
