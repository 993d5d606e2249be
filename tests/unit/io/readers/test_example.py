"""The example of a reader, as a package of somebody else would have it."""

import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from teachpath import ImportSettings, ReadOptions, UnusableRecording

EXAMPLE = Path(__file__).parents[4] / "clients" / "examples" / "09_a_reader_of_your_own.py"


def wand_file(folder: Path, damage: str = "") -> Path:
    """Write a hand that carries something along an arc in 2 s, held by the button from 0.4 s to 1.6 s."""
    lines = ["WAND 1"]
    for milliseconds in range(0, 2001, 20):
        share = min(max((milliseconds - 400) / 1200, 0.0), 1.0)
        x, y, z = 580.0, -280.0 + 560.0 * share, 520.0 + 100.0 * np.sin(np.pi * share)
        lines.append(f"{milliseconds},{x},{y},{z:.3f},{int(400 <= milliseconds < 1600)}")
    file = folder / "arc.wand"
    file.write_text("\n".join(lines[:1] + ([damage] if damage else []) + lines[1:]) + "\n")
    return file


def test_a_package_with_the_example_makes_its_format_known(tmp_path: Path) -> None:
    package = tmp_path / "package"
    described = package / "wand-1.0.dist-info"
    described.mkdir(parents=True)
    shutil.copy(EXAMPLE, package / "wand.py")
    (described / "METADATA").write_text("Metadata-Version: 2.1\nName: wand\nVersion: 1.0\n")
    (described / "entry_points.txt").write_text("[teachpath.readers]\nwand = wand:WAND\n")
    file = wand_file(tmp_path)
    command = [
        sys.executable,
        "-m",
        "teachpath",
        "import",
        "cup",
        str(file),
        "--dry-run",
        "--data",
        str(tmp_path / "data"),
    ]
    said = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": str(package)}, capture_output=True, text=True, check=False
    )
    assert said.returncode == 0, said.stderr
    assert "files of a wand" in said.stdout
    assert "positions in mm" in said.stdout


@pytest.mark.parametrize("damage", ["1,2,3", "a,b,c,d,e", "nan,0,0,0,0", "\x00"])
def test_a_damaged_file_ends_in_a_sentence(tmp_path: Path, damage: str) -> None:
    reader = runpy.run_path(str(EXAMPLE))["WAND"]
    file = wand_file(tmp_path, damage)
    assert reader.recognizes(file.read_bytes(), file.name)
    with pytest.raises(UnusableRecording, match="arc"):
        reader.read(file.read_bytes(), file.name, ReadOptions(), ImportSettings())
