"""Which links of an arm may collide with one another, computed from its solids over many configurations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Final

import mujoco
import numpy as np

from teachpath.motion.arm.geometry import LinkSolid, gripper_solids, may_meet
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.serial_mjcf import write_serial_mjcf
from teachpath.records import SerialArm

SAMPLES: Final = 400  # configurations

Pair = tuple[int, int]  # numbers of two links; 0: the base


@dataclass(frozen=True)
class SelfCollisionPairs:
    """Pairs of links with solids, by what they do in random configurations within the joints' limits.

    Attributes:
        neighbours: one joint is between them; they touch there, and are not checked.
        overlapping: in every configuration; the solids are too large there, and are not checked.
        meeting: in some configurations.
        separate: in all configurations; they are checked all the same.
    """

    neighbours: tuple[Pair, ...]
    overlapping: tuple[Pair, ...]
    meeting: tuple[Pair, ...]
    separate: tuple[Pair, ...]

    @property
    def checked(self) -> tuple[Pair, ...]:
        """Pairs that a plan keeps apart."""
        return tuple(sorted(self.meeting + self.separate))


@lru_cache(maxsize=8)
def self_collision_pairs(arm: SerialArm, samples: int = SAMPLES) -> SelfCollisionPairs:
    """Compute which links of an arm may collide; the same configurations are tried each time."""
    solids = {0: arm.base_solids, **{number: link.solids for number, link in enumerate(arm.links, start=1)}}
    solid = [number for number, shapes in solids.items() if shapes]
    pairs = [pair for pair in combinations(solid, 2) if pair[1] - pair[0] > 1]
    counts = _overlaps(arm, pairs, samples)
    return SelfCollisionPairs(
        neighbours=tuple((a, b) for a, b in combinations(solid, 2) if b - a == 1),
        overlapping=tuple(pair for pair, count in counts.items() if count == samples),
        meeting=tuple(pair for pair, count in counts.items() if 0 < count < samples),
        separate=tuple(pair for pair, count in counts.items() if count == 0),
    )


def checked_solid_pairs(solids: Mapping[int, LinkSolid], arm: Arm) -> list[Pair]:
    """Return the pairs of an arm's solids, by the numbers that they have here, which a plan keeps apart."""
    every = combinations(solids.items(), 2)
    if arm.model is None:
        return [(one, two) for (one, a), (two, b) in every if may_meet(a, b, arm)]
    checked, gripper = set(self_collision_pairs(arm.model).checked), {solid.name for solid in gripper_solids(arm)}

    def may_collide(a: LinkSolid, b: LinkSolid) -> bool:
        pair = min(a.link, b.link), max(a.link, b.link)
        is_gripper = not gripper.isdisjoint((a.name, b.name))
        return pair[1] - pair[0] > 1 if is_gripper else pair in checked

    return [(one, two) for (one, a), (two, b) in every if may_collide(a, b)]


def _overlaps(arm: SerialArm, pairs: list[Pair], samples: int) -> dict[Pair, int]:
    """Count the configurations in which the solids of each pair of links overlap."""
    model = mujoco.MjModel.from_xml_string(write_serial_mjcf(arm))
    data = mujoco.MjData(model)
    geoms = [np.flatnonzero(model.geom_bodyid == model.body(name).id) for name in _bodies(arm)]
    lower, upper = ([getattr(joint, side).value for joint in arm.joints] for side in ("lower", "upper"))
    every = [(k, int(a), int(b)) for k, (one, two) in enumerate(pairs) for a in geoms[one] for b in geoms[two]]
    of, first, second = np.array(every, dtype=np.int64).reshape(-1, 3).T
    reach = model.geom_rbound[first] + model.geom_rbound[second]
    counts = np.zeros(len(pairs), dtype=np.int64)
    for q in np.random.default_rng(0).uniform(lower, upper, (samples, len(arm.links))):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        near = np.linalg.norm(data.geom_xpos[first] - data.geom_xpos[second], axis=1) <= reach
        met = set[int]()
        for k in np.flatnonzero(near):
            if of[k] not in met and mujoco.mj_geomDistance(model, data, first[k], second[k], 0.001, None) <= 0.0:
                met.add(int(of[k]))
        counts[list(met)] += 1
    return dict(zip(pairs, counts.tolist(), strict=True))


def _bodies(arm: SerialArm) -> list[str]:
    return ["base", *(f"link{number}" for number in range(1, len(arm.links) + 1))]
