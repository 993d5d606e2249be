"""Fields that records were given after digests and signatures had been computed over them.

Such a field, `field(default=..., metadata=LATER_FIELD)`, enters no digest while it has its default, so that the digests
and signatures of before hold.
"""

from __future__ import annotations

from dataclasses import Field
from typing import Any, Final

LATER_FIELD: Final = {"later": True}


def enters_digest(declared: Field[Any], value: object) -> bool:
    """Tell whether a record's field with this value is part of the record's digest."""
    return "later" not in declared.metadata or value != declared.default
