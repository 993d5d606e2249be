"""How measured figures are printed: what, median with least and most, unit, and the ratio to something named."""

import os
import platform
from dataclasses import dataclass
from statistics import median

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Figure:
    """One line of the report.

    Args:
        what: what is measured.
        values: one a repetition.
        unit: of the values.
        beside: the limit or peer that it is held against, with its value in words.
        ratio: median over that limit or peer, or None when there is none.
    """

    what: str
    values: tuple[float, ...]
    unit: str
    beside: str = ""
    ratio: float | None = None


def against(what: str, values: list[float], unit: str, *, name: str, value: float) -> Figure:
    """Return a figure with its ratio to the limit or peer `name` of `value`, in the same unit."""
    return Figure(what, tuple(values), unit, f"{name}: {_short(value)} {unit}", median(values) / value)


def print_report(title: str, figures: list[Figure]) -> None:
    """Print a table of figures."""
    table = Table(title=title, title_justify="left")
    for name, side in (("what", "left"), ("median", "right"), ("least .. most", "right"), ("unit", "left")):
        table.add_column(name, justify="right" if side == "right" else "left")
    table.add_column("beside")
    table.add_column("ratio", justify="right")
    for figure in figures:
        many = len(figure.values) > 1
        table.add_row(
            figure.what,
            _short(median(figure.values)),
            f"{_short(min(figure.values))} .. {_short(max(figure.values))}" if many else "",
            figure.unit,
            figure.beside,
            "" if figure.ratio is None else f"{figure.ratio:.3g}",
        )
    Console(width=160).print(table)


def machine() -> str:
    """Say in one line what this is measured on."""
    load = os.getloadavg()[0]
    return (
        f"{os.cpu_count()} cores, {platform.machine()}, {platform.system()} {platform.release()}, "
        f"Python {platform.python_version()}, load before the run {load:.2f}"
    )


def _short(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"
