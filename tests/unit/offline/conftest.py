"""Data folders of a station, as fixtures."""

import shutil
from pathlib import Path

import pytest

from tests.unit.offline.damage import (
    make_station,
)


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    data = tmp_path_factory.mktemp("station") / "data"
    make_station(data, torn=100)
    return data


@pytest.fixture
def data(template: Path, tmp_path: Path) -> Path:
    """A station with three whole demonstrations and nothing else."""
    folder = tmp_path / "data"
    shutil.copytree(template, folder)
    for part in folder.rglob("*.part"):
        part.unlink()
    return folder
