"""The drawings of a review package, as SVG: the dendrogram with its cut, and how the models learned."""

from __future__ import annotations

from html import escape

from teachpath.learning.clustering.cuts import Dendrogram, dendrogram
from teachpath.offline.report.content import Review
from teachpath.offline.report.scene import way_color

WIDE, LEFT, ROW = 620.0, 34.0, 17.0


def tree(review: Review) -> str:
    """Draw how the demonstrations merge: leaves on the left, heights to the right, the cut as a line."""
    learned = review.run.learned
    if len(learned.demonstrations) < 2:
        return ""
    shape = dendrogram(learned, len(learned.demonstrations))
    top = 1.1 * max([height for _, _, height, _ in shape.merges] + [shape.threshold]) or 1.0
    row = min(ROW, 420.0 / len(shape.leaves))
    tall = row * len(shape.leaves) + 8
    ways = {member: cluster.index for cluster in learned.clusters for member in cluster.members}
    marks = [_leaf(review.number(name), ways.get(name, 0), 4 + (i + 0.5) * row) for i, name in enumerate(shape.leaves)]
    cut = LEFT + shape.threshold / top * (WIDE - LEFT - 8)
    line = f'<line x1="{cut:.1f}" x2="{cut:.1f}" y1="0" y2="{tall:.1f}" class="cut"/>'
    links = _links(shape, ways, row, top)
    label = f"Dendrogram of {len(shape.leaves)} demonstrations, cut into {len(learned.clusters)} ways"
    return _svg(tall, label, "".join(links) + "".join(marks) + line)


def _links(shape: Dendrogram, ways: dict[str, int], row: float, top: float) -> list[str]:
    places = {name: 4 + (i + 0.5) * row for i, name in enumerate(shape.leaves)}
    nodes = [(LEFT, places[name], ways.get(name, 0)) for name in shape.demonstrations]
    drawn = []
    for left, right, height, _ in shape.merges:
        (xa, ya, way), (xb, yb, other) = nodes[left], nodes[right]
        x = LEFT + height / top * (WIDE - LEFT - 8)
        joined = way if way == other and height <= shape.threshold else 0
        color = f"#{way_color(joined):06x}" if joined else "#7a8694"
        dashed = "" if joined else ' stroke-dasharray="3 3"'
        drawn.append(f'<path d="M{xa:.1f},{ya:.1f}H{x:.1f}V{yb:.1f}H{xb:.1f}" stroke="{color}"{dashed} class="link"/>')
        nodes.append((x, (ya + yb) / 2, joined))
    return drawn


def _leaf(number: int, way: int, y: float) -> str:
    color = f"#{way_color(way):06x}" if way else "#7a8694"
    text = f'<text x="{LEFT - 10:.0f}" y="{y + 4:.1f}" text-anchor="end">{number}</text>'
    return f'{text}<circle cx="{LEFT - 3:.0f}" cy="{y:.1f}" r="3" fill="{color}"/>'


def convergence(review: Review, tall: float = 180.0) -> str:
    """Draw the log-likelihood of every way's model against the training iterations (the paper's Fig. 4)."""
    curves = [(c.index, c.convergence) for c in review.run.learned.clusters if len(c.convergence) > 1]
    if not curves:
        return ""
    values = [value for _, curve in curves for value in curve]
    low, span = min(values), max(values) - min(values) or 1.0
    longest = max(len(curve) for _, curve in curves)
    left, bottom = 64.0, tall - 22
    lines = []
    for index, curve in curves:
        at = [
            (left + i / (longest - 1) * (WIDE - left - 10), bottom - (value - low) / span * (bottom - 10))
            for i, value in enumerate(curve)
        ]
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
        lines.append(f'<polyline points="{points}" stroke="#{way_color(index):06x}" class="curve"/>')
    axes = f'<path d="M{left},6V{bottom}H{WIDE - 8}" class="axis"/>'
    texts = [
        f'<text x="{left - 6}" y="{y:.0f}" text-anchor="end">{value:,.0f}</text>'
        for y, value in ((14, low + span), (bottom, low))
    ]
    texts.append(f'<text x="{WIDE - 8}" y="{tall - 6}" text-anchor="end">iteration {longest}</text>')
    return _svg(tall, "Log-likelihood of every way's model while it was trained", axes + "".join(lines + texts))


def _svg(tall: float, label: str, content: str) -> str:
    return f'<svg viewBox="0 0 {WIDE:.0f} {tall:.0f}" role="img" aria-label="{escape(label)}">{content}</svg>'
