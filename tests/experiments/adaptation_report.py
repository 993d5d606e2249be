"""What is asked of adapted paths, and how the report shows what they reach."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

LINE, SAME_FRAME, METHOD_NAMES = "straight line", "TP-GMM, same frame and ends", "adapted path"
SHARES = {3: 0.5, 5: 0.45, 8: 0.43}  # of the straight line's median distance, asked by number of demonstrations
RIVALS = {SAME_FRAME: 0.95, "TP-GMM": 0.65, "DMP": 0.65, "ProMP": 0.65}  # likewise, of theirs by five

Row = dict[str, Any]  # the figures of a method for a number of demonstrations


def targets(rows: Sequence[Row]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked of adapted paths: what, how much, what was measured, whether it is kept."""
    of = {(row["n"], row["method"]): row for row in rows}
    told = []
    for count, share in SHARES.items():
        row = of[count, METHOD_NAMES]
        low, high = row["interval"]
        what = f"adapted by {count} demonstrations"
        measured = f"{row['share']:.3f} ({low:.3f} to {high:.3f})"
        told.append((f"{what}: median RMS, of the straight line's", f"≤ {share}", measured, row["share"] <= share))
        told.append((f"{what}: largest distance, likewise", "≤ 0.5", f"{row['largest']:.3f}", row["largest"] <= 0.5))
        held = row["held"]["share"]
        told.append((f"{what}: held by two standard deviations", "≥ 90%", f"{held:.1%}", held >= 0.9))
        if row["turn"] is not None:
            told.append((f"{what}: orientation", "≤ 8°", f"{row['turn']:.1f}°", row["turn"] <= 8))
    for name, share in RIVALS.items():
        ratio = of[5, METHOD_NAMES]["median"] / of[5, name]["median"]
        told.append((f"adapted by 5, median RMS, of that of {name}", f"≤ {share}", f"{ratio:.3f}", ratio <= share))
    p90 = of[5, METHOD_NAMES]["p90"] / of[5, SAME_FRAME]["p90"]
    told.append((f"adapted by 5, 90th percentile, of that of {SAME_FRAME}", "≤ 0.92", f"{p90:.3f}", p90 <= 0.92))
    return told


def section(rows: Sequence[Row], data: str) -> list[str]:
    """Return the part of the report about adapted paths, as HTML."""
    lines = []
    for row in rows:
        low, high = row["interval"]
        cells = [
            f"<td class=l>{row['n'] if row['method'] == LINE else ''}<td class=l>{escape(row['method'])}",
            f"<td>{100 * row['median']:.2f} / {100 * row['p90']:.2f}",
            f"<td>{row['share']:.2f} <small>{low:.2f}–{high:.2f}</small><td>{row['largest']:.2f}",
            f"<td>{row['held']['share']:.1%}" if "held" in row else "<td>",
            f"<td>{row['turn']:.1f}°" if row.get("turn") else "<td>",
        ]
        lines.append(f"<tr{' class=last' if row['method'] == METHOD_NAMES else ''}>{''.join(cells)}")
    heads = "<th>RMS, median / p90 [cm]<th>of the line's<th>largest, of the line's<th>held by 2 sd<th>orientation"
    return [
        "<h2>An object that lies elsewhere</h2>",
        f"<p>Each of {escape(data)} is predicted from its start and goal by n others, drawn at random. The adapted "
        "path is what <code>teachpath adapt</code> makes of what is learned from the others at the usual settings; its "
        "orientation at both ends is given. TP-GMM, DMP and ProMP follow their publications; in the same frame they "
        "have start and goal, the direction between them and its power of the distance, as kriging has.</p>",
        f"<table><tr><th class=l>n<th class=l>Method{heads}{''.join(lines)}</table>",
    ]
