"""How a live hand leads the arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class TeleoperationSettings:
    """How a live hand leads the arm."""

    # `keep`: the tool keeps its orientation and stays short of a hand that it cannot follow; `follow`: it turns too
    orientation: Literal["keep", "follow"] = "keep"
