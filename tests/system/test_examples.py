"""The examples of the clients, in their order, against one running service."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from teachpath.io.store.motions import read_motion
from teachpath_client import ClientError
from tests.system.operators import STARVED_REASONS
from tests.system.processes import Service, run
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

EXAMPLES = Path(__file__).parents[2] / "clients" / "examples"


def example(name: str, *arguments: str, meanwhile: Callable[[], object] = lambda: None) -> str:
    """Run an example to its end and return what it printed; do something again and again meanwhile."""
    command = [sys.executable, "-W", "error", str(EXAMPLES / name), "--task", "arc", *arguments]
    clean = {key: value for key, value in os.environ.items() if not key.startswith("TEACHPATH_")}
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        running = subprocess.Popen(command, env=clean, stdout=out, stderr=err)
        try:
            wait_until(lambda: (meanwhile(), running.poll() is not None)[1], f"{name} ends")
        finally:
            running.kill()
            running.wait()
        for stream in (out, err):
            stream.seek(0)
        printed, said = out.read(), err.read()
    assert running.returncode == 0, printed + said
    assert said == ""
    return printed


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service whose arm is the driver of the examples, in place of the simulated one."""
    folder = tmp_path_factory.mktemp("driven")
    with Service(folder / "data", TEACHPATH_SIMULATOR__START="false") as service:
        command = [sys.executable, "-W", "error", str(EXAMPLES / "04_drive_a_robot.py"), "--endpoint", service.endpoint]
        driver = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        try:
            yield service
            assert driver.poll() is None, driver.stderr and driver.stderr.read()
        finally:
            driver.kill()
            driver.communicate()


def test_the_examples_show_a_task_learn_it_and_run_it_on_a_robot_of_their_own(driven: Service, tmp_path: Path) -> None:
    shown = example("01_publish_a_demonstration.py", "--endpoint", driven.endpoint, "--speed", "4")
    assert shown == "3 demonstrations of 600 samples, 0 lost\n"
    assert [d.verdict for d in driven.station.demonstrations("arc")] == ["clean"] * 3

    learned = example("02_learn_over_rest.py", "--url", driven.url)
    assert "way 1: " in learned
    assert all(f"  demonstration {number}: " in learned for number in (1, 2, 3))
    assert "control points, at most" in learned

    driven.station.wait_for_arm(timeout=HANG)

    def resume_when_starved() -> None:
        for execution in driven.station.executions():
            if execution.status.state == "held" and execution.status.reason.startswith(
                (*STARVED_REASONS, "nothing was heard")
            ):
                with suppress(ClientError):  # the example is in control, and gives it to whoever asks for it
                    driven.station.set_lease(driven.station.claim_lease("test", seconds=60.0, ask=True).token)
                with suppress(ClientError):
                    driven.station.steer(execution.id, "resume")

    ran = example("03_run_a_path.py", "--url", driven.url, meanwhile=resume_when_starved)
    assert "of a limit by joint" in ran
    assert "\nended: tracking error" in ran
    (execution,) = driven.station.executions()
    assert execution.status.state == "ended"
    assert execution.status.progress == 1.0
    assert driven.station.health().processes.keys() == {"executor"}
    _judge(driven, execution.id, tmp_path)


def _judge(service: Service, execution: str, folder: Path) -> None:
    """Fetch what was executed, look at it as curves, and judge it; then a log that was tampered with."""
    ended = service.data / "executions" / f"{execution}.mcap"
    wait_until(ended.exists, "the recording is whole")
    drawn = service.station.series(execution, points=100)
    assert len(drawn.times) == 100
    assert drawn.gripper_closed.count(True) > 10
    file = folder / "run.mcap"
    file.write_bytes(service.station.recorded_execution(execution))
    good = run("run", "--check", str(file), folder=folder)
    if service.station.get_execution(execution).status.missed:  # the executor got no turn, and the log says so
        assert all("not one period apart" in line for line in good.out.splitlines() if "BROKEN" in line)
    else:
        assert good.process.returncode == 0, good.out + good.err
        assert "run.mcap keeps every limit and the path" in good.out
    motion = read_motion(file)
    rows = [[s.nominal_ns / 1e9, *s.position.tolist()] for s in motion.setpoints]
    rows[len(rows) // 2][1] += 0.001
    log = folder / "log.csv"
    log.write_text("t,q1,q2,q3,q4,q5,q6\n" + "\n".join(",".join(map(repr, row)) for row in rows))
    assert motion.header is not None
    assert motion.header.plan is not None
    bad = run("run", motion.header.plan.id, "--check", str(log), "--url", service.url, folder=folder)
    assert bad.process.returncode == 1
    assert "log.csv breaks" in bad.err
    assert "BROKEN: jerk limit used to" in bad.out


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.py")), ids=lambda f: f.name)
def test_an_example_is_short_and_says_what_it_is_for(file: Path) -> None:
    lines = file.read_text().splitlines()
    assert len(lines) <= 60
    assert file.name in "\n".join(lines[:10])


def test_an_example_without_a_service_says_what_is_missing() -> None:
    command = [sys.executable, str(EXAMPLES / "02_learn_over_rest.py"), "--url", "http://127.0.0.1:9"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=HANG)
    assert ended.returncode == 1
    assert "start it with: teachpath serve" in ended.stderr
    assert "Traceback" not in ended.stderr
