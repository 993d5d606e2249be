"""The arm of this process: one published variant, chosen once, before anything is computed with it."""

from __future__ import annotations

from typing import Final

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.puma560 import DEFAULT_VARIANT, VARIANTS, Variant


class _Choice:
    """A variant that can be chosen until it is used."""

    def __init__(self) -> None:
        self._name, self._used = DEFAULT_VARIANT, False

    def choose(self, name: str) -> None:
        if name not in VARIANTS:
            raise UnusableSettings(f"setting motion.variant is {name!r}; known: {', '.join(VARIANTS)}")
        if self._used and name != self._name:
            raise UnusableSettings(
                f"this process has computed with the arm {self._name} already and cannot go on with {name}; start it "
                "anew with the other setting motion.variant"
            )
        self._name = name

    def take(self) -> Variant:
        self._used = True
        return VARIANTS[self._name]


_CHOICE: Final = _Choice()


def choose(variant: str) -> None:
    """Make a published variant the arm of this process.

    Raises:
        UnusableSettings: there is no such variant, or this process has computed with another one: never a mix.
    """
    _CHOICE.choose(variant)


def arm() -> Variant:
    """Return the arm of this process; from now on it has no other."""
    return _CHOICE.take()
