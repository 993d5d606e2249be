"""What is set aside is removed when somebody says so, and never a demonstration."""

import os
import time
from pathlib import Path

import pytest

from teachpath.errors import UnusableInput
from teachpath.offline.pruning import DAY, prune
from tests.unit.offline.damage import contradictions, examined, make_station

OLD_DAYS = 10  # days


def test_only_what_is_set_aside_and_old_is_removed(tmp_path: Path) -> None:
    data = tmp_path / "data"
    make_station(data, 2, torn=100)
    assert len(examined(data)) == 1
    (data / "aside-1").mkdir()
    (data / "executions").mkdir(exist_ok=True)
    for name in ("executions/e1.mcap", "executions/e2.torn", "recordings/lift/new.mcap.copy", "aside-1/file"):
        (data / name).write_bytes(b"")
    then = time.time() - (OLD_DAYS + 1) * DAY
    for path in data.rglob("*"):
        if path.name != "new.mcap.copy":
            os.utime(path, (then, then))
    aside = ["aside-1", "e2.torn", "demo-torn.mcap.part.salvaged"]
    assert [path.name for path in prune(data, OLD_DAYS, dry_run=True)] == aside
    assert [path.name for path in prune(data, OLD_DAYS)] == aside
    assert not (data / "aside-1").exists()
    assert prune(data, OLD_DAYS) == []
    assert [path.name for path in prune(data, OLD_DAYS, executions=True)] == ["e1.mcap"]
    assert contradictions(data) == []
    with pytest.raises(UnusableInput, match="under 0"):
        prune(data, -1.0)
