"""python -m tests.experiments.motion_phases FOLDER: are taking and putting found in hand-polhemus recordings?

Every recording is also tried with noise, rare or doubled readings, rests, spikes, a pause on the way and pieces of it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from teachpath.recording.motion_phases import PhaseEvidence, find_motion_phases
from teachpath.records import Array
from tests.experiments.adaptation import LABEL_ERRORS, SAMPLING_PERIOD

FAR_DISTANCE = 0.05  # [m] from the label; nothing that is called sure may lie farther
Change = Callable[[Array, Array, Array, np.random.Generator], Array]


@dataclass(frozen=True, eq=False)
class Labelled:
    """A recording: positions (n, 3) [m], and where it was taken and put (2, 3), with the nearest readings (2,)."""

    name: str
    positions: Array
    places: Array
    indices: Array


def labelled(folder: Path) -> list[Labelled]:
    """Read the recordings whose labels have no typing errors."""
    found = []
    for file in sorted(folder.glob("*.traj")):
        if file.stem in LABEL_ERRORS:
            continue
        positions = np.array(file.read_text().split(), dtype=np.float64).reshape(-1, 4, 4)[:, :3, 3]
        places = np.loadtxt(file.with_name(file.name + ".res"))
        nearest = [int(np.argmin(np.linalg.norm(positions - place, axis=1))) for place in places]
        order = np.argsort(nearest)
        found.append(Labelled(file.stem, positions, places[order], np.array(nearest)[order]))
    return found


def _rest(positions: Array, at: int, count: int, rng: np.random.Generator, noise: float = 0.0005) -> Array:
    rest = positions[at] + rng.normal(0, noise, (count, 3))
    return np.concatenate([positions[:at], rest, positions[at:]])


def _spikes(p: Array, _g: Array, _r: Array, rng: np.random.Generator) -> Array:
    changed = p.copy()
    changed[rng.choice(len(p), 5, replace=False)] += rng.normal(0, 0.2, (5, 3))
    return changed


CHANGES: dict[str, Change] = {
    "as recorded": lambda p, g, r, rng: p,
    "noise of 2 mm": lambda p, g, r, rng: p + rng.normal(0, 0.002, p.shape),
    "noise of 10 mm": lambda p, g, r, rng: p + rng.normal(0, 0.010, p.shape),
    "every 4th reading": lambda p, g, r, rng: p[::4],
    "doubled readings": lambda p, g, r, rng: np.repeat(p[::2], 2, axis=0),
    "rests at taking": lambda p, g, r, rng: _rest(p, int(g), 100, rng),
    "spikes of 20 cm": _spikes,
}
UNDECIDABLE_CASES: dict[str, Change] = {
    "a pause on the way": lambda p, g, r, rng: _rest(p, int(g + r) // 2, 60, rng),
    "up to the middle of the transport": lambda p, g, r, rng: p[: int(g + r) // 2],
    "from the middle of the transport": lambda p, g, r, rng: p[int(g + r) // 2 :],
}


def main() -> None:
    """Print how far the places found are from the labelled ones."""
    if len(sys.argv) != 2 or not (recordings := labelled(Path(sys.argv[1]))):
        raise SystemExit(f"{__doc__}\n\nFOLDER has to hold *.traj files with their *.traj.res")
    table = Table(
        "recordings", "sure", "median cm", "p90 cm", "largest cm", f"sure, over {100 * FAR_DISTANCE:.0f} cm off"
    )
    for what, change in (CHANGES | UNDECIDABLE_CASES).items():
        table.add_row(what, *_row(recordings, change, decidable=what in CHANGES))
    Console().print(table)


def _row(recordings: list[Labelled], change: Change, *, decidable: bool) -> list[str]:
    errors, far, sure = [], 0, 0
    for number, one in enumerate(recordings):
        rng = np.random.default_rng([number, 13])
        positions = change(one.positions, *one.indices, rng)
        found = find_motion_phases(SAMPLING_PERIOD * np.arange(len(positions)), positions)
        if found.evidence is not PhaseEvidence.DWELLS:
            continue
        sure += 1
        error = np.linalg.norm(found.places - one.places, axis=1)
        errors += error.tolist()
        far += bool(error.max() > FAR_DISTANCE)
    share = f"{sure} of {len(recordings)}"
    if not errors or not decidable:
        return [share, "", "", "", str(far)]
    return [share, *(f"{100 * np.quantile(errors, q):.1f}" for q in (0.5, 0.9, 1.0)), str(far)]


if __name__ == "__main__":
    main()
