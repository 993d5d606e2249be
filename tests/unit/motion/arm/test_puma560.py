from dataclasses import fields
from itertools import pairwise
from typing import get_args, get_type_hints

import mujoco
import numpy as np
import pytest

from teachpath.motion.arm.geometry import collision_solids, visual_solids
from teachpath.motion.arm.mjcf import physical_inertia, write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import (
    DEFAULT_VARIANT,
    VARIANTS,
    Link,
    Variant,
)
from teachpath.motion.collision.builtin_scenes import builtin_scenes, paper_scene
from teachpath.motion.settings import MotionSettings

ARM = Arm.of_variant()

PROBE = '<geom name="probe" type="sphere" size="0.0001" contype="0" conaffinity="0"/>'
SQUARE = np.array([0.5**0.5, 0.5**0.5, 1.0])  # the corners of a square within a circle

every_variant = pytest.mark.parametrize("variant", VARIANTS.values(), ids=list(VARIANTS))


@every_variant
def test_every_column_names_its_source(variant: Variant) -> None:
    assert set(variant.sources) == {field.name for field in fields(Link)}
    assert all(variant.sources.values())


def test_the_variants_are_those_of_the_setting_and_differ() -> None:
    assert get_args(get_type_hints(MotionSettings)["variant"]) == tuple(VARIANTS)
    assert len({variant.links for variant in VARIANTS.values()}) == len(VARIANTS)


@every_variant
def test_what_a_variant_does_not_name_is_the_defaults_and_limits_are_alike(variant: Variant) -> None:
    for column, source in variant.sources.items():
        of = [[getattr(link, column) for link in v.links] for v in (variant, VARIANTS[DEFAULT_VARIANT])]
        alike = column in ("lower", "upper", "torque", "speed", "acceleration") or "not given there, so" in source
        assert of[0] == of[1] or not alike


@every_variant
def test_the_simulated_inertia_differs_only_where_no_body_can_have_the_published_one(variant: Variant) -> None:
    for link in variant.links:
        moments = physical_inertia(link)
        assert 2 * moments.max() <= moments.sum()
        published = np.array(link.inertia)
        if link.mass and 2 * published.max() <= published.sum():
            np.testing.assert_array_equal(moments, published)


@every_variant
def test_the_acceleration_box_keeps_every_torque_at_full_speed(variant: Variant) -> None:
    arm = Arm.of_variant(variant.name)
    model = mujoco.MjModel.from_xml_string(write_mjcf(builtin_scenes()["empty"], arm))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT  # neither contacts nor joint stops
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    worst = np.zeros(6)
    for _ in range(300):
        data.qpos[:6] = rng.uniform(arm.limits.lower, arm.limits.upper)
        data.qvel[:6] = arm.limits.speed * rng.choice([-1.0, 1.0], 6)
        data.qacc[:6] = arm.limits.acceleration * rng.choice([-1.0, 1.0], 6)
        wanted = data.qacc[:6].copy()
        mujoco.mj_forward(model, data)
        data.qacc[:6] = wanted
        mujoco.mj_inverse(model, data)
        worst = np.maximum(worst, np.abs(data.qfrc_inverse[:6]) / arm.limits.torque)
    assert worst.max() <= 1.0


def test_every_part_is_a_geom_of_its_link() -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(paper_scene(), ARM))
    for part in collision_solids():
        assert model.geom_bodyid[model.geom(part.name).id] == (model.body(f"link{part.link}").id if part.link else 0)
    assert len({part.name for part in visual_solids()}) == len(visual_solids())


def test_what_is_drawn_alone_stands_out_by_millimetres() -> None:
    """Every corner of a trim lies within 6 mm of a solid of the same link."""
    model = mujoco.MjModel.from_xml_string(
        write_mjcf(builtin_scenes()["empty"], ARM).replace("</worldbody>", PROBE + "</worldbody>")
    )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    probe = model.geom("probe").id
    for part in (part for part in visual_solids() if part.visual_only):
        pose = data.body(f"link{part.link}") if part.link else data.body(0)
        reach = part.size if part.kind == "box" else (2 * part.size[0], 2 * part.size[0], part.size[1])
        for sign in np.ndindex(2, 2, 2):
            corner = np.array(part.position) + (np.array(sign) - 0.5) * reach * (1.0 if part.kind == "box" else SQUARE)
            data.geom_xpos[probe] = pose.xpos + pose.xmat.reshape(3, 3) @ corner
            near = [s for s in collision_solids() if s.link == part.link]
            gaps = [mujoco.mj_geomDistance(model, data, probe, model.geom(s.name).id, 1.0, None) for s in near]
            assert min(gaps) < 0.006, part.name


def test_motors_are_limited_to_the_published_torques() -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(paper_scene(), ARM))
    np.testing.assert_allclose(model.actuator_ctrlrange, np.column_stack([-ARM.limits.torque, ARM.limits.torque]))
    np.testing.assert_allclose(model.jnt_range[:6], np.column_stack([ARM.limits.lower, ARM.limits.upper]))


def test_the_parts_join_into_one_arm_in_every_configuration() -> None:
    chain = ["foot", "pedestal", "trunk", "shoulder", "upper arm", "forearm", "wrist roll", "wrist yoke", "wrist"]
    chain += ["flange", "palm", "left finger"]
    model = mujoco.MjModel.from_xml_string(write_mjcf(paper_scene(), ARM))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(4)
    for _ in range(20):
        data.qpos[:6] = rng.uniform(ARM.limits.lower, ARM.limits.upper)
        mujoco.mj_kinematics(model, data)
        for one, other in pairwise(chain):
            gap = mujoco.mj_geomDistance(model, data, model.geom(one).id, model.geom(other).id, 1.0, None)
            assert gap < 0.006, (one, other)
