"""Make a file format of your own a reader, so that `teachpath import` and the page take it.

The made-up format *wand* has lines of milliseconds, three millimetres and a button, behind one that says WAND 1. In a
package of yours, name the reader `WAND` in pyproject.toml, and every station that has the package finds it:

    [project.entry-points."teachpath.readers"]
    wand = "mypackage.mymodule:WAND"

    python 09_a_reader_of_your_own.py FILE
"""

import sys
from pathlib import Path

import numpy as np

import teachpath

HEAD = b"WAND 1\n"


def read_wand(
    content: bytes, name: str, options: teachpath.ReadOptions, limits: teachpath.ImportSettings
) -> teachpath.FileMotions:
    """Read all lines; what every import is checked for (clock, jumps, sizes) is checked behind the reader."""
    lines = content.removeprefix(HEAD).decode(errors="replace").splitlines()
    if len(lines) > limits.max_samples:
        raise teachpath.UnusableRecording(f"{name}: {len(lines)} samples, limit {limits.max_samples}; split the file")
    rows = np.empty((len(lines), 5))
    for number, line in enumerate(lines):
        try:
            rows[number] = [float(cell) for cell in line.split(",")]
        except ValueError as error:
            raise teachpath.UnusableRecording(
                f"{name}, line {number + 2}: {line[:40]!r} is no wand reading: {error}"
            ) from None
    if not np.isfinite(rows).all():
        raise teachpath.UnusableRecording(f"{name}: a number is not finite; take out that line")
    stamps = np.asarray(rows[:, 0] * 1e6, np.int64)
    return teachpath.FileMotions(
        [teachpath.Track(stamps, rows[:, 1:4] / 1000.0, closure=rows[:, 4])], ("time in ms", "positions in mm")
    )


WAND = teachpath.Reader("wand", "files of a wand", read_wand, lambda content, name: content.startswith(HEAD))

if __name__ == "__main__":
    motions = read_wand(
        Path(sys.argv[1]).read_bytes(), sys.argv[1], teachpath.ReadOptions(), teachpath.ImportSettings()
    )
    for track in motions.tracks:
        print(f"{len(track.positions)} readings in {track.times[-1]:.2f} s; {', '.join(motions.understood)}")
