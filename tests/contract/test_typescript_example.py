"""The examples in TypeScript teach a station, by the node of the dev extra, and say what the station says."""

import subprocess
import sys
from pathlib import Path

from tests.contract.desk import Desk, csv
from tests.waiting import HANG

EXAMPLES = Path(__file__).parents[2] / "clients" / "examples"
NODE = Path(sys.executable).with_name("node")


def run(example: str, *words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([NODE, EXAMPLES / example, *words], capture_output=True, text=True, timeout=HANG, check=False)


def test_a_program_in_typescript_teaches_a_station(desk: Desk, port: int, tmp_path: Path) -> None:
    shown, broken = tmp_path / "cups & plates.csv", tmp_path / "broken.csv"
    shown.write_text(csv())
    broken.write_text("a,b\n1,2\n")
    url = f"http://127.0.0.1:{port}"

    said = run("07_teach_from_typescript.ts", url, "from-typescript", str(shown))
    assert said.returncode == 0, said.stderr
    (made,) = desk.get("/tasks/from-typescript/demonstrations").json()
    assert made["source"] == shown.name
    assert said.stdout == (
        f"from-typescript 1: {made['verdict']}, {made['duration']:.2f} s, made at {made['created_ns']} ns\n"
    )

    refused = run("07_teach_from_typescript.ts", url, "from-typescript", str(broken))
    assert refused.returncode != 0
    assert "no column for t, x, y, z" in refused.stderr


def test_a_tracker_in_typescript_shows_a_demonstration(desk: Desk, port: int) -> None:
    said = run("08_track_from_typescript.ts", f"http://127.0.0.1:{port}", "typescript-arc", "100")
    assert said.returncode == 0, said.stderr
    (made,) = desk.get("/tasks/typescript-arc/demonstrations").json()
    assert (made["source"], made["verdict"]) == ("typescript-hand", "clean")
    assert said.stdout.splitlines()[1] == f"typescript-arc 1: clean, {made['duration']:.2f} s"
    assert desk.get("/tasks/typescript-arc/recording").json() == []
