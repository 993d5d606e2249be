"""The tables of a review package, as HTML; every text that came from outside is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from teachpath.offline.report.content import Review
from teachpath.offline.report.scene import way_color
from teachpath.records import Extreme, LearnedPath, Plan

USES = ("position_use", "velocity_use", "acceleration_use", "jerk_use", "torque_use")


def ways(review: Review) -> str:
    """Return one row a way: who agrees, how closely it is fitted, and what its plan promises."""
    rows = []
    for cluster in review.run.learned.clusters:
        path = next((p for p in review.paths if p.cluster == cluster.index), None)
        kept = sum(score.selected for score in cluster.scores)
        plan = review.plans.get(path.id) if path else None
        planned = [f"{plan.duration:.2f} s", f"{1e3 * plan.certificate.clearance.value:.0f} mm"] if plan else ["", ""]
        fitted = _fit(path) if path else ["", "", ""]
        members = ", ".join(str(review.number(member)) for member in cluster.members)
        rows.append([_way(cluster.index), members, f"{kept} of {len(cluster.members)}", *fitted, *planned])
    heads = ["Way", "Demonstrations", "Agree", "Control points", "Largest error", "Within", "Duration", "Clearance"]
    bare = [str(path.cluster) for path in review.paths if path.id not in review.plans]
    notes = [
        *_notes(review),
        *([f"Not certified in this version, and so without a motion: way {', '.join(bare)}."] if bare else []),
    ]
    return table(heads, rows) + "".join(_note(text) for text in notes)


def selection(review: Review) -> str:
    """Return the paper's Table I, with ranks, margins and the reasons."""
    rows = []
    for cluster in review.run.learned.clusters:
        for score in cluster.scores:
            why = score.note or (score.deviation.sentence if score.deviation else "")
            margin = "" if score.margin is None else f"{score.margin:.1f}"
            z = "" if score.z is None else f"{score.z:z.1f}"
            likely = "" if score.z is None else f"{score.log_likelihood:,.1f}"
            number = str(review.number(score.demonstration))
            rows.append(
                [
                    _way(cluster.index),
                    number,
                    str(score.rank),
                    z,
                    margin,
                    likely,
                    "✓" if score.selected else "–",
                    escape(why),
                ]
            )
    ranked = (
        "Ranked by z: how far one is from the others of its way in course, shape, smoothness and bending, in robust "
        "standard deviations; 0 is like them or better."
        if review.run.learned.mode == "default"
        else "Ranked by the log-likelihood under the model of the way."
    )
    note = f"{ranked} The margin is the lead over the next in rank. A way's path is fitted to what is kept (✓)."
    return table(["Way", "Shown", "Rank", "z", "Margin", "Log-likelihood", "Kept", "Why"], rows) + _note(note)


def demonstrations(review: Review) -> str:
    """Return every demonstration with its verdict and its account."""
    rows = [
        [
            str(d.number),
            escape(d.verdict),
            f"{d.duration:.2f} s",
            str(d.samples),
            str(d.statistics.lost),
            escape(d.source),
            escape("; ".join(d.reasons)),
        ]
        for d in review.demonstrations
    ]
    return table(["Shown", "Verdict", "Transport", "Samples", "Lost", "From", "Reasons"], rows)


def certificates(review: Review) -> str:
    """Return what each plan is certified for, or that there is none."""
    if not review.plans:
        return _note("No path has a plan yet: nothing is certified, and nothing moves.")
    rows = []
    for path in review.paths:
        plan = review.plans.get(path.id)
        if plan is not None:
            rows.append([_way(path.cluster), *_certificate(plan)])
    heads = ["Way", "Arm", "Joints", "Speed", "Acceleration", "Jerk", "Torque", "Clearance", "Digest"]
    return table(heads, rows) + _note("Uses are shares of the limits; at most 100 % is certified.")


def provenance(review: Review) -> str:
    """Return what it was made with: settings, library versions, digests of the input."""
    learned = review.run.learned
    parts: list[tuple[str, Iterable[tuple[str, object]]]] = [
        ("Settings", learned.settings.items()),
        ("Versions", learned.versions.items()),
        (
            "SHA-256 of the demonstrations",
            ((str(review.number(key)), digest) for key, digest in learned.inputs.items()),
        ),
    ]
    return "".join(
        f"<h3>{title}</h3>{table(None, [[escape(str(name)), escape(str(value))] for name, value in pairs])}"
        for title, pairs in parts
    )


def table(heads: Sequence[str] | None, rows: Sequence[Sequence[str]]) -> str:
    """Return a table of cells that are HTML already."""
    head = "" if heads is None else f"<thead><tr>{''.join(f'<th scope=col>{h}</th>' for h in heads)}</tr></thead>"
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table>{head}<tbody>{body}</tbody></table>"


def _certificate(plan: Plan) -> list[str]:
    c = plan.certificate
    uses = [_use(getattr(c, name)) for name in USES]
    clearance = f'<span title="{escape(c.clearance.place)}">{1e3 * c.clearance.value:.1f} mm</span>'
    return [escape(c.branch), *uses, clearance, f"<code>{escape(c.digest[:12])}</code>"]


def _use(extreme: Extreme) -> str:
    return f'<span title="{escape(extreme.place)}">{100 * extreme.value:.0f} %</span>'


def _fit(path: LearnedPath) -> list[str]:
    count = str(len(path.curve.control_points))
    if path.fit is None:  # edited by hand since
        return [count, f"edited, version {path.version}", ""]
    return [count, f"{1e3 * path.fit.largest:.1f} mm", f"{1e3 * path.fit.tube:.0f} mm"]


def _notes(review: Review) -> list[str]:
    learned = review.run.learned
    found = list(learned.notes)
    for cluster in learned.clusters:
        found += [f"Way {cluster.index}: {text}" for text in (cluster.note, cluster.ambiguous) if text]
    return found


def _way(cluster: int) -> str:
    mark = '<svg class="mark" viewBox="0 0 10 10" aria-hidden="true"><rect width="10" height="10" rx="2" {}/></svg>'
    return mark.format(f'fill="#{way_color(cluster):06x}"') + str(cluster)


def _note(text: str) -> str:
    return f'<p class="note">{escape(text)}</p>'
