"""How the report looks: its style, figures and numbers."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path

from teachpath.learning.evaluation import Rate

STYLE = """
:root { color-scheme: light; }
body { max-width: 62rem; margin: 3rem auto 6rem; padding: 0 1.5rem; color: #222; background: #fff;
  font: 16px/1.55 "Charter", "Iowan Old Style", "Palatino Linotype", Georgia, serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin-bottom: .3rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .6rem; }
.byline, figcaption, caption, .small { font: 13.5px/1.5 system-ui, sans-serif; color: #555; }
.abstract { border-left: 3px solid #0072b2; padding: .1rem 0 .1rem 1.2rem; margin: 1.8rem 0; }
figure { margin: 1.6rem 0 2rem; } figure img { width: 100%; height: auto; }
figcaption b, caption b { color: #222; }
caption { text-align: left; padding-bottom: .5rem; }
table { border-collapse: collapse; font: 13.5px/1.4 system-ui, sans-serif; margin: 1.2rem 0 1.8rem;
  font-variant-numeric: tabular-nums; display: block; overflow-x: auto; }
th, td { padding: .22rem .75rem .22rem 0; text-align: right; white-space: nowrap; }
th { border-bottom: 1px solid #222; font-weight: 600; vertical-align: bottom; }
th:first-child, td:first-child, .l { text-align: left; }
small { color: #888; font-size: 11.5px; }
tr.last td { border-bottom: 1px solid #ccc; }
.yes { font-weight: 700; } .no { color: #6b6b6b; }
.short { color: #b34700; font-weight: 600; } .kept { color: #00734f; }
"""


def figure(folder: Path, name: str, number: str, caption: str) -> str:
    """Return a figure with its PNG embedded."""
    image = b64encode((folder / f"{name}.png").read_bytes()).decode()
    alt = escape(caption, quote=True)
    return (
        f"<figure><img alt='{alt}' src='data:image/png;base64,{image}'>"
        f"<figcaption><b>{number}</b> {escape(caption)}</figcaption></figure>"
    )


def short(rate: Rate) -> str:
    """Return a rate and its interval in per cent."""
    low, high = rate.interval
    return f"{100 * rate.share:.1f} <small>{100 * low:.1f}–{100 * high:.1f}</small>"


def listed(numbers: Sequence[int | None]) -> str:
    """Return numbers as a list in words."""
    return ", ".join("–" if number is None else str(number) for number in numbers)
