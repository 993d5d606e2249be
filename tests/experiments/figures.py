"""The figures: one function each, from results to a PNG."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from teachpath.learning.evaluation import Rate
from teachpath.records import Array, Learned, Trajectory
from tests.experiments import quoted
from tests.experiments.scenarios import GROUPINGS, SCENARIOS, SHAPES, along
from tests.experiments.trials import MODES, course, learn, settings

PAGE_STYLE = Path(__file__).parents[2] / "clients" / "web" / "style.css"
PALETTE = re.findall(r"--way-\d+: (#[0-9a-f]{6})", PAGE_STYLE.read_text())  # as on the page
WAY_COLORS = dict(enumerate(PALETTE, 1))  # clusters, as in the 3-D view
MODE = {"default": PALETTE[0], "repaired": PALETTE[4], "paper": PALETTE[3]}
MARK = {1: "o", 2: "s", 3: "^"}
INK, PALE_COLOR, QUOTED_COLOR = "#222222", "#b8b8b8", "#666666"
VIEWS = (("from above", 1, 0), ("from the side", 1, 2))  # abscissa, ordinate
AXES = "xyz"
LOWEST_LOG_LIKELIHOOD = -1600  # log-likelihood at which the Fig. 4 of the paper ends; a blind start is far below

STYLE = {
    "figure.dpi": 160,
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#888888",
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#ececec",
    "xtick.color": "#555555",
    "ytick.color": "#555555",
    "legend.frameon": False,
    "savefig.bbox": "tight",
}


@contextmanager
def sheet(file: Path, rows: int, columns: int, size: tuple[float, float], **more: Any) -> Iterator[Any]:
    """Open a figure in the report's style, and write it to `file` at the end."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained", **more)
        yield figure, axes
        figure.savefig(file)
        plt.close(figure)


def convergence(file: Path, learned: Mapping[str, Learned]) -> None:
    """Fig. 4: log-likelihood of every cluster's model after each iteration."""
    with sheet(file, 1, 3, (9.6, 3.0)) as (_, (axes,)):
        for axis, mode in zip(axes, MODES, strict=True):
            axis.set_title(f"mode {mode}")
            axis.set_xlabel("iteration")
            for cluster in learned[mode].clusters:
                if len(cluster.convergence) == 0:
                    continue
                colour = WAY_COLORS[(cluster.index - 1) % len(WAY_COLORS) + 1]
                iterations = range(1, len(cluster.convergence) + 1)
                marker = MARK.get(cluster.index, "D")
                axis.plot(iterations, cluster.convergence, color=colour, marker=marker, ms=4, lw=1.6)
                axis.annotate(
                    f"cluster {cluster.index}",
                    (iterations[-1], cluster.convergence[-1]),
                    (6, 0),
                    textcoords="offset points",
                    color=colour,
                    va="center",
                )
            axis.set_xlim(0.5, 13.2)
            axis.set_xticks(range(1, 11))
        axes[0].set_ylim(
            LOWEST_LOG_LIKELIHOOD, max(cluster.convergence[-1] for cluster in learned["paper"].clusters) + 60
        )
        axes[0].set_ylabel("log-likelihood of the cluster")
        for cluster, level in quoted.SUMS.items():
            axes[0].axhline(level, color=WAY_COLORS[cluster], lw=1.1, ls=(0, (2, 3)), zorder=1)
        axes[0].plot([], [], color=QUOTED_COLOR, lw=0.9, ls=(0, (2, 3)), label="end levels printed in the paper")
        axes[0].legend(loc="lower right", fontsize=7.5)


def paths(file: Path, demonstrations: Mapping[str, Trajectory], learned: Mapping[str, Learned]) -> None:
    """Fig. 5: the learned curves and the sampled points, from two sides."""
    with sheet(file, 2, 3, (10.2, 5.8), sharex=True, sharey="row", height_ratios=(1.1, 1)) as (figure, axes):
        for column, mode in zip(axes.T, MODES, strict=True):
            column[0].set_title(f"mode {mode}")
            for axis, (_, across, up) in zip(column, VIEWS, strict=True):
                _paths_of(axis, demonstrations, learned[mode], across, up)
        _label_views(axes)
        handles = [
            Line2D([], [], color=INK, lw=2.4, label="learned NURBS"),
            Line2D([], [], color=INK, lw=0, marker="o", ms=4, label="samples of selected demonstrations"),
            Line2D([], [], color=INK, lw=0, marker="o", ms=4, alpha=0.25, label="samples of the others"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)


def _paths_of(axis: Axes, demonstrations: Mapping[str, Trajectory], learned: Learned, across: int, up: int) -> None:
    for cluster in learned.clusters:
        colour = WAY_COLORS[(cluster.index - 1) % len(WAY_COLORS) + 1]
        for score in cluster.scores:
            points = 100 * demonstrations[score.demonstration].positions[::4]
            alpha = 0.75 if score.selected else 0.22
            marker = MARK.get(cluster.index, "D")
            axis.plot(points[:, across], points[:, up], marker, color=colour, ms=2.3, mew=0, alpha=alpha)
    for cluster in learned.clusters:
        curve = 100 * course(learned, cluster.index)
        axis.plot(curve[:, across], curve[:, up], color="white", lw=4.0)
        axis.plot(curve[:, across], curve[:, up], color=WAY_COLORS[(cluster.index - 1) % len(WAY_COLORS) + 1], lw=2.2)


def _label_views(axes: Any) -> None:
    for row, (title, _across, up) in zip(axes, VIEWS, strict=True):
        row[0].set_ylabel(f"{title}\n{AXES[up]} [cm]")
        for axis in row:
            axis.set_aspect("equal")
    for axis in axes[-1]:
        axis.set_xlabel(f"{AXES[VIEWS[-1][1]]} [cm]")


def wiggles(file: Path, demonstrations: Mapping[str, Trajectory], learned: Mapping[str, Learned]) -> None:
    """Fig. 6: five demonstrations, the fifth of which wiggles, and the learned curve."""
    with sheet(file, 2, 3, (10.2, 4.0), sharex=True, sharey="row", height_ratios=(0.28, 1)) as (figure, axes):
        for column, mode in zip(axes.T, MODES, strict=True):
            kept = sorted(s.demonstration for c in learned[mode].clusters for s in c.scores if s.selected)
            column[0].set_title(f"mode {mode}", loc="left")
            column[0].set_title(
                f"learns from {', '.join(kept)}", loc="right", color=QUOTED_COLOR, weight="normal", size=9
            )
            for axis, (_, across, up) in zip(column, VIEWS, strict=True):
                for name, trajectory in demonstrations.items():
                    points = 100 * trajectory.positions
                    colour = PALETTE[1] if name == "5" else PALETTE[5]
                    axis.plot(
                        points[:, across], points[:, up], color=colour, lw=0.9, alpha=0.9 if name in kept else 0.5
                    )
                for cluster in learned[mode].clusters:
                    curve = 100 * course(learned[mode], cluster.index)
                    axis.plot(curve[:, across], curve[:, up], color="white", lw=4.0)
                    axis.plot(curve[:, across], curve[:, up], color=INK, lw=2.0)
        _label_views(axes)
        handles = [
            Line2D([], [], color=INK, lw=2.0, label="learned NURBS"),
            Line2D([], [], color=PALETTE[5], lw=1.4, label="demonstrations 1 to 4"),
            Line2D([], [], color=PALETTE[1], lw=1.4, label="demonstration 5, which wiggles"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)


def rejection(file: Path, rates: Mapping[str, Mapping[str, Rate]]) -> None:
    """Draw how often the marked demonstration is rejected, by scenario and mode, with 95 % intervals."""
    with sheet(file, 1, 1, (8.6, 5.6)) as (figure, ((axis,),)):
        for row, scenario in enumerate(SCENARIOS):
            _ladder(axis, row, {mode: rates[scenario.key][mode] for mode in MODES})
            axis.plot([scenario.chance] * 2, [row - 0.42, row + 0.42], color=QUOTED_COLOR, lw=1.4, ls=(0, (2, 2)))
            if scenario.key != "control":
                axis.plot([scenario.target] * 2, [row - 0.42, row + 0.42], color=INK, lw=1.2)
        axis.plot(quoted.REJECTED_SHARE, -0.42, marker="v", color=INK, ms=6, clip_on=False)
        _rows(axis, [scenario.title for scenario in SCENARIOS])
        axis.set_xlim(0, 1.015)
        axis.set_xlabel("runs in which it is not among the two most consistent")
        handles = [
            *(Line2D([], [], color=MODE[mode], marker="o", lw=2, label=f"mode {mode}") for mode in MODES),
            Line2D([], [], color=QUOTED_COLOR, lw=1.4, ls=(0, (2, 2)), label="chance"),
            Line2D([], [], color=INK, lw=1.2, label="asked of mode default"),
            Line2D([], [], color=INK, lw=0, marker="v", label="printed in the paper"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=8, columnspacing=1.2)


def places(file: Path, rates: Mapping[str, Sequence[Rate | None]]) -> None:
    """Draw the control: how often a demonstration like the others is rejected, by its place in the list."""
    with sheet(file, 1, 3, (9.0, 2.7), sharey=True) as (_, (axes,)):
        for axis, mode in zip(axes, MODES, strict=True):
            axis.axhspan(0.54, 0.66, color="#f0f0f0", zorder=0)
            axis.axhline(0.6, color=QUOTED_COLOR, lw=1.2, ls=(0, (2, 2)))
            for place, rate in enumerate(rates[mode], 1):
                if rate is None:
                    continue
                low, high = rate.interval
                axis.plot([place] * 2, [low, high], color=MODE[mode], lw=2)
                axis.plot(place, rate.share, "o", color=MODE[mode], ms=6)
            axis.set_title(f"mode {mode}")
            axis.set_xlabel("place in the list")
            axis.set_xticks(range(1, 6))
            axis.grid(axis="x", visible=False)
            axis.set_xlim(0.5, 5.5)
            axis.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        lows, highs = zip(*(rate.interval for each in rates.values() for rate in each if rate), strict=True)
        axes[0].set_ylim(min(0.45, *lows) - 0.02, max(0.75, *highs) + 0.02)
        axes[0].set_ylabel("rejected, though like the others")


def groupings(file: Path, rates: Mapping[str, Mapping[str, Rate]]) -> None:
    """Draw how often the grouping is exactly right."""
    with sheet(file, 1, 1, (8.6, 2.9)) as (figure, ((axis,),)):
        for row, ways in enumerate(GROUPINGS):
            _ladder(axis, row, {mode: rates[ways.key][mode] for mode in ("paper", "default")})
            axis.plot([ways.target] * 2, [row - 0.42, row + 0.42], color=INK, lw=1.2)
        _rows(axis, [ways.title for ways in GROUPINGS])
        axis.set_xlim(-0.015, 1.015)
        axis.set_xlabel("seeds in which clusters and ways are the same")
        handles = [
            Line2D([], [], color=MODE["paper"], marker="o", lw=2, label="modes paper and repaired"),
            Line2D([], [], color=MODE["default"], marker="o", lw=2, label="mode default"),
            Line2D([], [], color=INK, lw=1.2, label="asked of mode default"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8)


def repetitions(file: Path, rates: Mapping[str, Sequence[float]]) -> None:
    """Draw the rejection rate of one data set over repetitions, for many data sets."""
    with sheet(file, 1, 1, (8.6, 2.3)) as (_, ((axis,),)):
        for row, mode in enumerate(("paper", "repaired")):
            near = [round(value * 40) / 40 for value in sorted(rates[mode])]
            step = min(0.09, 0.8 / max(near.count(value) for value in near))
            for i, value in enumerate(near):
                at = near[:i].count(value) + 1
                up = at // 2 * (-1) ** at * step
                axis.plot(value, row + up, "o", color=MODE[mode], ms=6, mec="white", mew=0.6)
        axis.axvline(0.6, color=QUOTED_COLOR, lw=1.2, ls=(0, (2, 2)))
        axis.axvline(quoted.REJECTED_SHARE, color=INK, lw=1.2)
        axis.text(0.595, 1.62, "chance", ha="right", color=QUOTED_COLOR, fontsize=8)
        axis.text(quoted.REJECTED_SHARE - 0.005, 1.62, "the paper's one data set", ha="right", color=INK, fontsize=8)
        _rows(axis, ["mode paper", "mode repaired"])
        axis.set_ylim(1.75, -0.75)
        axis.set_xlim(0, 1.015)
        axis.set_xlabel("repetitions in which the wiggly demonstration is rejected; one dot a data set")


def shapes(file: Path) -> None:
    """Draw what modes paper and default make of paths that loop, come back or close."""
    with sheet(file, 1, len(SHAPES), (10.4, 3.2)) as (figure, (axes,)):
        for axis, shape in zip(axes, SHAPES, strict=True):
            demonstrations, mean = along(shape, 1)
            across, up = _widest(mean)
            for trajectory in demonstrations.values():
                points = 100 * trajectory.positions
                axis.plot(points[:, across], points[:, up], color=PALE_COLOR, lw=0.7)
            for mode in ("paper", "default"):
                learned = learn(demonstrations, settings(mode, 1, threshold=1.0))
                curve = 100 * course(learned, 1)
                axis.plot(curve[:, across], curve[:, up], color=MODE[mode], lw=2.2)
            axis.set_title(shape)
            axis.set_aspect("equal", adjustable="datalim")
            axis.set_xlabel(f"{AXES[across]} [cm]")
            axis.set_ylabel(f"{AXES[up]} [cm]", labelpad=1)
        handles = [
            Line2D([], [], color=PALE_COLOR, lw=1.2, label="demonstrations"),
            *(Line2D([], [], color=MODE[mode], lw=2.2, label=f"mode {mode}") for mode in ("paper", "default")),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)


def _widest(points: Array) -> tuple[int, int]:
    one, other = np.sort(np.argsort(np.ptp(points, axis=0))[1:])
    return int(one), int(other)


def _ladder(axis: Axes, row: int, rates: Mapping[str, Rate]) -> None:
    offsets = np.linspace(-0.24, 0.24, len(rates))
    for offset, (mode, rate) in zip(offsets, rates.items(), strict=True):
        low, high = rate.interval
        axis.plot([low, high], [row + offset] * 2, color=MODE[mode], lw=2, solid_capstyle="butt")
        axis.plot(rate.share, row + offset, "o", color=MODE[mode], ms=5.5, clip_on=False, zorder=4)


def _rows(axis: Axes, titles: Sequence[str]) -> None:
    axis.set_yticks(range(len(titles)), titles)
    axis.tick_params(axis="y", length=0, labelcolor=INK)
    axis.set_ylim(len(titles) - 0.45, -0.55)
    axis.grid(axis="y", visible=False)
    axis.xaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    axis.spines["left"].set_visible(False)
