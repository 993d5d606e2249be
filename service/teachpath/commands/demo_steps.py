"""The steps of the demo: a hand shows, a path is learned, planned and followed."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event
from typing import Any

from rich.console import Console

from teachpath.commands.progress import execution_shown, execution_state, job_shown, progress_bar
from teachpath.commands.tables import plan_lines, print_run
from teachpath.commands.work import replay_command
from teachpath.config import Settings
from teachpath.errors import PathRefused, TeachpathError, Unreachable, UnusableRecording
from teachpath_client.errors import ClientError, JobFailed
from teachpath_client.models import Demonstration, Execution, Plan, Run
from teachpath_client.station import Station

READY_TIMEOUT = 60.0  # [s] for executor and simulated arm to appear
MAX_RESUMES = 20  # tries to go on after the arm was held in one place
TERMINATE_TIMEOUT = 10.0  # [s] for the tracker client to end its recording, before it is killed


class _Stopped(TeachpathError):
    """The operator pressed Ctrl-C."""


class Demo:
    """The steps of the demo, in order; each prints what it did.

    Args:
        station: to speak to.
        settings: of that station.
        stop: is set when the operator ends the demo.
        console: to print to.
    """

    def __init__(self, station: Station, settings: Settings, stop: Event, console: Console) -> None:
        self._station, self._settings, self._stop, self._console = station, settings, stop, console
        self._held = 0
        self._came = 0.0  # share of the path behind the arm

    def run(self, *, speed: float, seed: int, recordings: Path | None) -> dict[str, Any]:
        """Run all steps and return a summary; raises TeachpathError or ClientError at the step that failed."""
        if recordings is None:
            task, reports = self._show_experiment(speed, seed)
        else:
            task, reports = self._show_recordings(recordings, speed)
        run = self._learn(task)
        plan = self._plan(task, run)
        # as late as possible: executor and arm come up while the hand shows
        self._station.wait_for_arm(lambda _: self._pause(0.0), timeout=READY_TIMEOUT)
        execution = self._execute(plan.id)
        return _summary(reports, run, plan, execution)

    def _show_experiment(self, speed: float, seed: int) -> tuple[str, list[dict[str, Any]]]:
        command = [sys.executable, "-m", "teachpath_client", "synthetic", "--task", "demo", "--scene", "paper"]
        command += ["--endpoint", self._settings.bus.endpoint, "--prefix", self._settings.bus.prefix]
        command += ["--seed", str(seed), "--speed", str(speed)]
        return "demo", self._record(command, "demo", 12)

    def _show_recordings(self, file: Path, speed: float) -> tuple[str, list[dict[str, Any]]]:
        try:
            content = file.read_bytes()
        except OSError as error:
            raise UnusableRecording(f"cannot read {file}: {error.strerror}") from None
        task = file.stem
        options: dict[str, Any] = {
            "name": file.name,
            "format": "robottasks",
            "units": "cm",
            "calibration": "robottasks",
        }
        stored = self._station.import_file(task, content, **options)
        self._console.print(f"imported {len(stored)} demonstrations from {file.name}; replaying them over Zenoh")
        command = replay_command(
            [d.id for d in stored],
            url=self._station.url,
            bus=self._station.health().bus,
            task=f"{task}-replayed",
            scene="empty",
            calibration="robottasks",
            speed=speed,
        )
        return f"{task}-replayed", self._record(command, f"{task}-replayed", len(stored))

    def _record(self, command: list[str], task: str, expected: int) -> list[dict[str, Any]]:
        """Run a tracker client in its own process and follow what the recorder makes of it."""
        with _client(command) as client, progress_bar("recording") as show:
            while client.poll() is None:
                made = len(self._demonstrations(task))
                show(made / expected, f"{made} of {expected} demonstrations")
                self._pause()
            out, _ = client.communicate()
            if client.returncode:
                raise TeachpathError(f"the tracker client failed with exit status {client.returncode}")
            show(1.0, f"{len(self._demonstrations(task))} of {expected} demonstrations")
        reports: list[dict[str, Any]] = [json.loads(line) for line in out.splitlines()]
        made = sum(len(report["demonstrations"]) for report in reports)
        if made != expected:
            notes = "; ".join(note for report in reports for note in report["notes"])
            raise TeachpathError(f"{made} of {expected} demonstrations were recorded: {notes or 'see the tracker'}")
        return reports

    def _demonstrations(self, task: str) -> list[Demonstration]:
        known = {known.name for known in self._station.tasks()}
        return self._station.demonstrations(task) if task in known else []

    def _learn(self, task: str) -> Run:
        with progress_bar("learning") as show:
            run = self._station.learn(task, on_change=job_shown(show))
        numbers = {d.id: d.number for d in self._demonstrations(task)}
        print_run(run, numbers, self._console)
        return run

    def _plan(self, task: str, run: Run) -> Plan:
        """Plan the paths in turn and return the first plan that is certified."""
        refusals = []
        for path in run.learned.paths:
            with progress_bar("planning") as show:
                try:
                    plan = self._station.plan(path.id, on_change=job_shown(show))
                except JobFailed as error:
                    refusals.append(f"{path.id}: {error}")
                    continue
            for refusal in refusals:
                self._console.print(f"not executable: {refusal}", highlight=False)
            self._console.print(plan_lines(plan), highlight=False)
            return plan
        raise PathRefused(f"no learned path of {task} is executable: {' | '.join(refusals)}")

    def _execute(self, plan: str) -> Execution:
        with progress_bar("moving") as show:
            shown = execution_shown(show)

            def show_unless_stopped(execution: Execution) -> None:
                """Show how the execution stands, and resume one that is held."""
                self._pause(0.0)
                shown(execution)
                if execution.status.progress > self._came:
                    self._came, self._held = execution.status.progress, 0
                if execution.status.state == "held":
                    self._resume(execution)

            return self._station.run(plan, on_change=show_unless_stopped)

    def _resume(self, execution: Execution) -> None:
        """Resume a held arm as an operator would, e.g. when this machine was too busy for a moment."""
        state = execution_state(execution)
        self._console.print(f"{state}; resuming", highlight=False)
        with suppress(ClientError):  # still silent, or off its place: the next round tries again
            self._station.steer(execution.id, "resume")
        self._held += 1
        if self._held > MAX_RESUMES:
            raise Unreachable(f"the arm was held {MAX_RESUMES} times: {state}")
        self._pause(0.5)

    def _pause(self, seconds: float = 0.2) -> None:
        if self._stop.wait(seconds):
            raise _Stopped("stopped by the operator before the demo was over")


@contextmanager
def _client(command: list[str]) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(TERMINATE_TIMEOUT)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _summary(reports: list[dict[str, Any]], run: Run, plan: Plan, execution: Execution) -> dict[str, Any]:
    learned, status = run.learned, execution.status
    return {
        "demonstrations": sum(len(r["demonstrations"]) for r in reports),
        "samples": sum(r["received"] for r in reports),
        "lost_samples": sum(r["lost"] for r in reports),
        "clusters": [len(c.members) for c in learned.clusters],
        "selected": [sum(s.selected for s in c.scores) for c in learned.clusters],
        "paths": [
            {
                "id": p.id,
                "control_points": len(p.curve.control_points),
                "largest_error_m": p.fit.largest if p.fit else None,
            }
            for p in learned.paths
        ],
        "plan": plan.id,
        "planned_path": plan.path,
        "plan_duration_s": plan.duration,
        "least_clearance_m": plan.certificate.clearance.value,
        "largest_limit_use": status.limit_use,
        "largest_tracking_error_rad": status.tracking_error,
        "setpoints": status.cycles,
        "setpoints_late": status.late,
        "setpoints_missed": status.missed,
        "lateness_p50_us": status.lateness_p50_us,
        "lateness_p99_us": status.lateness_p99_us,
        "execution": status.state,
    }
