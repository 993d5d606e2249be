"""Two hundred doctors that are killed at random moments: how often something was lost or doubled."""

import json
import subprocess
import sys
import tempfile

from tests.bench.report import Figure


def measure(count: int) -> list[Figure]:
    """Let doctors die over data folders with a fault of each kind."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "tests.unit.offline.doctor_kills", folder, str(count), "7"]
        found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return [
        Figure("data folders examined", (float(count),), "folders"),
        Figure("  doctors killed over them", (float(found["killed"]),), "doctors"),
        Figure("  with something lost, doubled or left", (float(len(found["wrong"])),), "folders", "allowed: 0"),
    ]
