"""The digest of a plan, by which a change is noticed."""

from __future__ import annotations

import hashlib
from dataclasses import replace

from teachpath.errors import PathRefused
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.canonical import canonical
from teachpath.records import Plan


def digest(plan: Plan, arm: Arm) -> str:
    """Compute the SHA-256 (hex) over all that decides the motion, what was measured on it, and the arm.

    It notices changes, and anybody can compute it; which station made a plan, and for whom, is told by its signature
    (`signature.py`).
    """
    measured = replace(plan.certificate, digest="", signature=None)
    return hashlib.sha256(canonical([replace(plan, id="", author="", certificate=measured), arm])).hexdigest()


def with_digest(plan: Plan, arm: Arm) -> Plan:
    """Return a plan whose certificate has the digest of all that it says."""
    return replace(plan, certificate=replace(plan.certificate, digest=digest(plan, arm)))


def verify(plan: Plan, arm: Arm) -> None:
    """Check that a plan is the one that was certified, for this arm.

    Raises:
        PathRefused: the digest does not match: path, scene, limits or timing have changed since, or the arm is another.
    """
    if digest(plan, arm) != plan.certificate.digest:
        raise PathRefused(
            f"plan {plan.id} has changed since it was certified, or is for another arm than the {arm.identity} "
            "with this tool, payload and limit of speed (motion.arm, variant, tool_length, tool_position, "
            "tool_orientation, payload_mass, payload_center, tool_speed); plan the path again"
        )
