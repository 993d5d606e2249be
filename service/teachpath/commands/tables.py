"""What the commands print: the table of clusters in the form of the paper's Table I, and plans."""

from __future__ import annotations

import math
from datetime import datetime

from rich.console import Console
from rich.table import Table

from teachpath.lengths import describe_length
from teachpath_client.models import Dendrogram, Plan, Posture, Run, Signature, ToolOutput


def print_run(run: Run, numbers: dict[str, int], console: Console | None = None) -> None:
    """Print what a run learned: clusters, paths, and what an operator should know.

    Args:
        run: of learning.
        numbers: of the demonstrations, by id.
        console: to print to; None: the standard output.
    """
    out = console or Console()
    out.print(clusters_table(run, numbers))
    out.print(paths_table(run))
    for line in reasons(run, numbers):
        out.print(line, highlight=False)


def clusters_table(run: Run, numbers: dict[str, int]) -> Table:
    """Return clusters, members, log-likelihoods and the selected ones of a run (Aleotti & Caselli 2005, Table I).

    In mode default it shows the robust z as well, since that selects there and no log-likelihood does.

    Args:
        run: of learning.
        numbers: of the demonstrations, by id.
    """
    learned = run.learned
    by_z = learned.mode == "default"
    table = Table(title=f"Results of trajectory clustering ({learned.mode} mode)")
    if by_z:
        table.caption = "Robust z selects: 0 is like the others."
    for name in ("Cluster", "Demonstration", "Log-likelihood", *(["Robust z"] if by_z else []), "Selected"):
        table.add_column(name, justify="right" if name != "Selected" else "center")
    for cluster in learned.clusters:
        for i, score in enumerate(cluster.scores):
            table.add_row(
                str(cluster.index) if i == 0 else "",
                str(numbers.get(score.demonstration, score.demonstration)),
                f"{score.log_likelihood:.3f}",
                *(["" if score.z is None else f"{score.z:.2f}"] if by_z else []),
                "yes" if score.selected else "",
                end_section=i == len(cluster.scores) - 1,
            )
    return table


def reasons(run: Run, numbers: dict[str, int]) -> list[str]:
    """Return what an operator should know of a run: who was left out and why, and the notes on clusters and run."""
    lines = []
    for cluster in run.learned.clusters:
        for score in cluster.scores:
            if score.note and not score.selected:
                number = numbers.get(score.demonstration, score.demonstration)
                lines.append(f"demonstration {number} was left out: {score.note}")
        lines += [f"cluster {cluster.index}: {note}" for note in (cluster.note, cluster.ambiguous) if note]
    return lines + list(run.learned.notes)


def paths_table(run: Run) -> Table:
    """Return the learned paths of a run: degree, control points, errors."""
    table = Table(title="Learned paths")
    for name in ("Path", "Degree", "Control points", "Largest error", "Tube radius"):
        table.add_column(name, justify="right")
    for path in run.learned.paths:
        curve, fit = path.curve, path.fit
        errors = (describe_length(fit.largest), describe_length(fit.tube)) if fit else ("", "")
        table.add_row(path.id, str(curve.degree), str(len(curve.control_points)), *errors)
    return table


def cuts_table(dendrogram: Dendrogram) -> Table:
    """Return the cuts of a run to choose from."""
    table = Table(title=f"Cuts of {len(dendrogram.leaves)} demonstrations")
    for name in ("Clusters", "Height", "Members", "Now"):
        table.add_column(name, justify="left" if name == "Members" else "right")
    for cut in dendrogram.cuts:
        upper = "" if cut.highest is None else f" to {100 * cut.highest:.2f}"
        heights = f"{100 * cut.lowest:.2f}{upper} cm{'' if upper else ' and above'}"
        sizes = ", ".join(str(end - begin) for begin, end in cut.leaf_ranges)
        now = "*" if cut.clusters == dendrogram.clusters else ""
        table.add_row(str(cut.clusters), heights, sizes, now)
    return table


def plan_lines(plan: Plan) -> str:
    """Return a plan's certificate in a few lines."""
    c = plan.certificate
    uses = {
        "position": c.position_use,
        "velocity": c.velocity_use,
        "acceleration": c.acceleration_use,
        "jerk": c.jerk_use,
        "torque": c.torque_use,
    }
    limit = f", limit {plan.tool_speed:g}" if plan.tool_speed else ""
    speed_line = f"  fastest: {c.tool_speed.place} at {c.tool_speed.value:.3f} m/s{limit}\n" if c.tool_speed else ""
    return (
        f"plan {plan.id}: {plan.duration:.2f} s along {plan.lengths[-1]:.3f} m, arm {c.branch}\n"
        f"  largest use of the limits: {', '.join(f'{name} {use.value:.0%}' for name, use in uses.items())}\n"
        f"{speed_line}"
        f"  least clearance {describe_length(c.clearance.value)} ({c.clearance.place})\n"
        f"{_posture(plan.posture)}{_output(plan.output)}{_author(plan.author)}"
        f"  {_scope(c.signature)}"
    )


def _posture(posture: Posture | None) -> str:
    if posture is None:
        return ""
    away = f"{math.degrees(posture.distance.value):.1f} deg ({posture.distance.place})"
    return f"  at most {away} from the joints shown in demonstration {posture.demonstration}\n"


def _output(output: ToolOutput | None) -> str:
    if output is None:
        return ""
    return (
        f"  {output.name} is on along the path, and for {output.start:g} s before it and {output.end:g} s behind it\n"
    )


def _author(author: str) -> str:
    return f"  planned for {author}\n" if author else ""


def _scope(signature: Signature | None) -> str:
    """Return for what a certificate holds, and until when."""
    if signature is None:
        return "not signed: no arm follows it; plan the path again"
    names = ", ".join(calibration.name for calibration in signature.calibrations)
    until = datetime.fromtimestamp(signature.expires_ns / 1e9).astimezone()
    under = f", calibration {names}" if names else ""
    place = ", ".join(f"{1e3 * value:.6g}" for value in signature.tool.position) if signature.tool else ""
    tool = f" with its tool at ({place}) mm" if place else ""
    return f"holds for the {signature.arm}{tool}{under}, until {until:%Y-%m-%d %H:%M}"
