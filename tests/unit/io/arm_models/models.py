"""Arms in URDF and MJCF for tests: the examples of the package, changed in one place."""

from pathlib import Path

from teachpath.io.arm_models.examples import EXAMPLES

SIX_AXIS, SEVEN_AXIS = EXAMPLES["six-axis"], EXAMPLES["seven-axis"]


def changed(folder: Path, example: Path, *changes: tuple[str, str]) -> Path:
    """Write an example with passages replaced, each of which it must have, and return the file."""
    text = example.read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after, 1)
    file = folder / example.name
    file.write_text(text)
    return file


def limits(folder: Path, text: str) -> Path:
    file = folder / "limits.toml"
    file.write_text(text)
    return file
