"""The settings of the preview."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt, Le


@dataclass(frozen=True)
class PreviewSettings:
    """How often the view is drawn, and for how long a hand is shown."""

    # [Hz] how often arm, object and hands are drawn
    rate: Annotated[float, Gt(0), Le(60)] = 30.0
    # [Hz] how often the trail of a hand is drawn
    trail_rate: Annotated[float, Gt(0), Le(30)] = 5.0
    # points in the trail of a hand
    trail_points: Annotated[int, Ge(2), Le(10_000)] = 600
    # [s] without a sample after which a hand disappears
    hand_silence: Annotated[float, Gt(0)] = 2.0
