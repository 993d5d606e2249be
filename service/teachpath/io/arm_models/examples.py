"""Models of arms that come with the package: made for it, of no maker, under its licence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

_FOLDER: Final = Path(__file__).parent / "models"
EXAMPLES: Final[Mapping[str, Path]] = {
    "six-axis": _FOLDER / "six_axis.urdf",
    "seven-axis": _FOLDER / "seven_axis.xml",
}


def model_file(named: str | Path) -> Path:
    """Return the model's file of that path, or of an example of that name where there is no such file."""
    path = Path(named)
    return path if path.exists() else EXAMPLES.get(str(named), path)
