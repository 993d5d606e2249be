"""What an imported file may expand to; checked while it is read, before the memory is used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt


@dataclass(frozen=True)
class ImportSettings:
    """What a file that is imported may expand to."""

    # samples in one file, of all its motions together
    max_samples: Annotated[int, Ge(100)] = 500000
    # motions in one file, each of which becomes a demonstration
    max_motions: Annotated[int, Ge(1)] = 1000
    # bytes that the compressed chunks of one file may expand to
    max_expanded_size: Annotated[int, Ge(65536)] = 268435456
    # [s] that one motion may last
    max_duration: Annotated[float, Gt(0)] = 86400.0
