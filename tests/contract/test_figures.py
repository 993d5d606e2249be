"""`make figures` counts what it says."""

from pathlib import Path

from tests.bench.figures import SourceFigures, sources

SOURCE = '''
def explained():
    """Why."""
    def within(): ...

class Bare:
    def method(self): ...
    def _private(self): ...
'''


def test_modules_functions_and_docstrings_of_public_definitions_are_counted() -> None:
    assert SourceFigures.of([SOURCE, ""]) == SourceFigures(modules=2, lines=8, functions=4, public=3, explained=1)


def test_what_is_generated_or_others_work_is_not_counted(tmp_path: Path) -> None:
    (tmp_path / "room" / "vendor").mkdir(parents=True)
    for name in ("room/one.py", "room/keys_pb2.py", "room/vendor/theirs.py", "room/page.js", "beside.py"):
        (tmp_path / name).write_text(name)
    assert sources(tmp_path, ("room",), ".py") == ["room/one.py"]
