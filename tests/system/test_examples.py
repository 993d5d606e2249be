"""The examples of the clients, in their order, against one running service."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.system.processes import Service, wait_until

pytestmark = pytest.mark.system

EXAMPLES = Path(__file__).parents[2] / "clients" / "examples"


def example(name: str, *arguments: str) -> str:
    """Run an example to its end and return what it printed."""
    command = [sys.executable, "-W", "error", str(EXAMPLES / name), "--task", "arc", *arguments]
    clean = {key: value for key, value in os.environ.items() if not key.startswith("TEACHPATH_")}
    ended = subprocess.run(command, env=clean, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert ended.stderr == ""
    return ended.stdout


def test_the_examples_show_a_task_learn_it_and_run_it(service: Service) -> None:
    shown = example("01_publish_a_demonstration.py", "--endpoint", service.endpoint, "--speed", "4")
    assert shown == "3 demonstrations of 600 samples, 0 lost\n"
    assert [d["verdict"] for d in service.demonstrations("arc")] == ["clean"] * 3

    learned = example("02_learn_over_rest.py", "--url", service.url)
    assert "way 1: " in learned
    assert all(f"  demonstration {number}: " in learned for number in (1, 2, 3))
    assert "control points, at most" in learned

    wait_until(lambda: service.call("GET", "/health")["executor"], seconds=20, what="the executor is there")
    ran = example("03_run_a_path.py", "--url", service.url)
    assert "velocity_use" in ran
    assert "\nended: tracking error" in ran
    (execution,) = service.call("GET", "/executions")
    assert execution["status"]["state"] == "ended"
    assert execution["status"]["progress"] == 1.0


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.py")), ids=lambda f: f.name)
def test_an_example_is_short_and_says_what_it_is_for(file: Path) -> None:
    lines = file.read_text().splitlines()
    assert len(lines) < 60
    assert file.name in "\n".join(lines[:10])


def test_an_example_without_a_service_says_what_is_missing() -> None:
    command = [sys.executable, str(EXAMPLES / "02_learn_over_rest.py"), "--url", "http://127.0.0.1:9"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 1
    assert "is `teachpath serve` running?" in ended.stderr
