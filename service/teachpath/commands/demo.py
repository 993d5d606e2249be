"""demo: the main job from one command, on real sockets, files and processes."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Event
from typing import Annotated, Any

import typer
from rich.console import Console

from teachpath.commands.options import Config, settings_of
from teachpath.commands.serving import free_port, serving, until_signalled
from teachpath.commands.tables import clusters_table, paths_table, plan_lines, reasons
from teachpath.commands.work import execution_shown, execution_state, job_shown, progress_bar, replay_command
from teachpath.config import Settings
from teachpath.errors import PathRefused, TeachpathError, Unreachable, UnusableRecording
from teachpath_client.errors import ClientError, JobFailed
from teachpath_client.models import Demonstration, Execution, Plan, Run
from teachpath_client.station import Station

READY_TIMEOUT = 60.0  # [s] for executor and simulated arm to appear
MAX_RESUMES = 20  # tries to go on after the arm was held in one place
TERMINATE_TIMEOUT = 10.0  # [s] for the tracker client to end its recording, before it is killed
console = Console(stderr=True)


def demo(
    speed: Annotated[float, typer.Option(min=0.1, max=20, help="How fast the hand moves; 1 = real time.")] = 4.0,
    once: Annotated[bool, typer.Option("--once", help="End after the arm has moved, instead of staying up.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON; --once does so too.")] = False,
    seed: Annotated[int, typer.Option(help="Of the synthetic hand.")] = 1,
    recordings: Annotated[
        Path | None,
        typer.Option(help="Instead of the synthetic hand: import a RoboTasks file and replay it."),
    ] = None,
    port: Annotated[int | None, typer.Option(help="Web port; 8765, or a free one when that is taken.")] = None,
    data: Annotated[Path | None, typer.Option(help="Keep the data in this folder; else it is thrown away.")] = None,
    config: Config = None,
) -> None:
    """Show the whole way once, on this machine.

    A hand in a process of its own shows the paper's first experiment over Zenoh: twelve demonstrations, three ways
    around two obstacles. They are recorded, clustered and fitted; the first executable path is certified, and the
    simulated Puma 560 carries the box along it while you watch in the browser.
    """
    with ExitStack() as stack:
        folder = data or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="teachpath-demo-")))
        settings = _settings(config, folder, port)
        stop = stack.enter_context(until_signalled())
        stack.enter_context(serving(settings))
        url = f"http://{settings.web.host}:{settings.web.port}"
        console.print(f"teachpath serves [bold]{url}[/bold]: open it to watch; API docs at {url}/docs", highlight=False)
        station = stack.enter_context(Station(url, operator="teachpath demo"))
        summary = _Demonstration(station, settings, stop).run(speed=speed, seed=seed, recordings=recordings)
        if as_json or once:
            print(json.dumps(summary, indent=2), flush=True)
        if not once:
            console.print(f"The service stays up at {url} until Ctrl-C.")
            stop.wait()


class _Stopped(TeachpathError):
    """The operator pressed Ctrl-C."""


class _Demonstration:
    """The steps of the demo, in order; each prints what it did."""

    def __init__(self, station: Station, settings: Settings, stop: Event) -> None:
        self._station, self._settings, self._stop = station, settings, stop
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
        console.print(f"imported {len(stored)} demonstrations from {file.name}; replaying them over Zenoh")
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
        console.print(clusters_table(run, numbers))
        console.print(paths_table(run))
        for line in reasons(run, numbers):
            console.print(line, highlight=False)
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
                console.print(f"not executable: {refusal}", highlight=False)
            console.print(plan_lines(plan), highlight=False)
            return plan
        raise PathRefused(f"no learned path of {task} is executable: {' | '.join(refusals)}")

    def _execute(self, plan: str) -> Execution:
        with progress_bar("moving") as show:
            shown = execution_shown(show)

            def show_unless_stopped(execution: Execution) -> None:
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
        console.print(f"{state}; resuming", highlight=False)
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


def _settings(config: Path | None, folder: Path, port: int | None) -> Settings:
    """Keep to the default ports, or take free ones when somebody is there."""
    settings = settings_of(config, folder)
    web = port or (settings.web.port if _is_free(settings.web.port) else free_port())
    endpoint = settings.bus.endpoint
    if not _is_free(int(endpoint.rsplit(":", 1)[1])):
        endpoint = f"tcp/127.0.0.1:{free_port()}"
    return settings_of(config, folder, web={"port": web}, bus={"endpoint": endpoint})


def _is_free(port: int) -> bool:
    try:
        socket.create_server(("127.0.0.1", port)).close()
    except OSError:
        return False
    return True


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
