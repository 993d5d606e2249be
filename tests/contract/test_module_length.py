"""No module is longer than can be overlooked: 300 lines, tests included."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
MAX_LENGTH = 300  # lines
GENERATED_PARTS = ("vendor", "node_modules", "assets", "_pb2", "teachpath_client/models.py", "/help/", "/types/")
# One desk of a station for all tests of answers that come late: another module would start another station.
LONGER_MODULES = {"tests/system/test_late_answers.py"}


def test_no_module_is_longer_than_can_be_overlooked() -> None:
    rooms = ("service", "clients", "proto", "tests", "tools")
    files = [file for room in rooms for suffix in ("py", "js") for file in (ROOT / room).rglob(f"*.{suffix}")]
    own = {file.relative_to(ROOT).as_posix(): file for file in files}
    own = {place: file for place, file in own.items() if not any(part in f"/{place}" for part in GENERATED_PARTS)}
    assert len(own) > 900
    lengths = {place: len(file.read_text(encoding="utf-8").splitlines()) for place, file in own.items()}
    assert {place: length for place, length in lengths.items() if length > MAX_LENGTH}.keys() == LONGER_MODULES
