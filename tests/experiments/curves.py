"""The curves of Fig. 5 and 6: how near they stay to what they were learned from, beside what is published."""

from __future__ import annotations

from collections.abc import Mapping

from tests.experiments.results import Found
from tests.experiments.trials import MODES

HEAD = (
    "<th class=l>Experiment<th>cluster<th class=l>mode<th>degree<th>control<br>points<th>bound<th>points from<br>the "
    "curve<th>curve from<br>the samples<th>end from<br>a shown goal"
)


def table(experiments: Mapping[str, Found]) -> str:
    """Return the table of the curves of some experiments, by their names."""
    rows = [
        _row(name, mode, cluster) for name, modes in experiments.items() for mode in MODES for cluster in modes[mode]
    ]
    return (
        "<table><caption><b>The curves of Fig. 5 and 6</b>, lengths in cm, as largest distances. Published are the "
        "figures alone (“tight fitting of the sampled points”), without bound, degree or number of control points. "
        "Modes paper and repaired approximate as the publication's library does: from the polygon of the sorted "
        "points, by removing knots (The NURBS Book, A9.8 to A9.10). No part swings farther than the bound. But sorted "
        "by Euclidean distance to the start, as the publication has it (III-C), the points of two demonstrations "
        "alternate, so that their polygon zigzags, and A9.8 to A9.10 keep the order that they are given; and a path "
        "that comes down on its goal ends at the sample farthest from the start. The bound of 0.5 cm is widened "
        "until 60 control points suffice."
        f"</caption><tr>{HEAD}{''.join(rows)}</table>"
    )


def _row(name: str, mode: str, cluster: Found) -> str:
    fit = cluster["fit"]
    lengths = (fit["bound"], fit["largest"], cluster["away_from_samples"], cluster["end_from_goal"])
    cells = "".join(f"<td>{100 * length:.2f}" for length in lengths)
    count = cluster["control_points"]
    return f"<tr><td>{name}<td>{cluster['cluster']}<td class=l>{mode}<td>{cluster['degree']}<td>{count}{cells}"
