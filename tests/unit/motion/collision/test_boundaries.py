"""Floor and zones: what is measured is what points all over the arm and the object say."""

import numpy as np
import pytest

from teachpath.motion.arm.kinematics import downward_poses, inverse_kinematics
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape
from tests.unit.motion.collision.solids import Surface

ARM = Arm.of_variant()
HOME = np.array(MotionSettings().home)
TIP = 0.005  # m, of the fingers below the grasp point
TURNED_ORIENTATION = (np.cos(np.pi / 12), 0.0, 0.0, np.sin(np.pi / 12))


def over(x: float, y: float, z: float) -> np.ndarray:
    """A configuration with the tool pointing down at a place, elbow up."""
    return inverse_kinematics(downward_poses(np.array([[x, y, z]]), 0.0), ARM).joints[:, 1]


@pytest.mark.parametrize("floor", [0.0, -0.1, 0.25])
def test_the_distance_of_the_fingers_to_the_floor_is_the_gap_below_them(floor: float) -> None:
    model = CollisionModel(Scene("s", floor=floor), ARM)
    for gap in (0.03, -0.02):
        (least,) = model.clearances(over(0.55, 0.1, floor + TIP + gap))
        assert least.distance == pytest.approx(gap, abs=1e-6)
        assert least.other_body == "the floor"
        assert "finger" in least.body


def test_the_foot_may_stand_on_the_floor() -> None:
    assert CollisionModel(Scene("s"), ARM).clearances(HOME)[0].other_body != "the floor"


def test_an_object_may_touch_the_floor_that_it_stands_on_and_no_more() -> None:
    scene = Scene("s", carried=Shape("block", "box", (0.06, 0.06, 0.06), (0.5, 0.1, 0.03)))
    model = CollisionModel(scene, ARM)
    q = over(0.5, 0.1, 0.03)
    load = grasped_load(model, q[0])
    assert load is not None
    assert model.clearances(q, load=load)[0].body != "block"
    (resting,) = model.support_distances(q, load)
    assert (resting.body, resting.other_body) == ("block", "the floor")
    assert resting.distance == pytest.approx(0.0, abs=1e-6)
    assert model.support_distances(over(0.5, 0.1, 0.02), load)[0].distance == pytest.approx(-0.01, abs=1e-6)


def test_what_is_lifted_off_a_table_keeps_off_the_floor() -> None:
    table = Shape("table", "box", (0.2, 0.2, 0.1), (0.5, 0.1, 0.05))
    block = Shape("block", "box", (0.06, 0.06, 0.06), (0.5, 0.1, 0.13))
    model = CollisionModel(Scene("s", (table,), block), ARM)
    load = grasped_load(model, over(0.5, 0.1, 0.13)[0])
    (least,) = model.clearances(over(0.5, -0.2, 0.04), load=load)
    assert (least.body, least.other_body) == ("block", "the floor")
    assert least.distance == pytest.approx(0.01, abs=1e-6)


def test_arm_and_object_are_measured_against_zones() -> None:
    scene = Scene(
        "s",
        carried=Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.52)),
        keep_in=(Shape("cell", "box", (2.0, 1.2, 2.0), (0.4, 0.0, 0.9)),),
        keep_out=(Shape("person", "cylinder", (0.1, 2.0), (0.9, 0.0, 1.0)),),
    )
    model = CollisionModel(scene, ARM)
    load = grasped_load(model, over(0.5, 0.0, 0.52)[0])
    (ahead,) = model.clearances(over(0.75, 0.0, 0.6), load=load)
    assert ahead.other_body == "the keep-out zone person"
    assert ahead.distance <= 0.03 + 1e-5
    (aside,) = model.clearances(over(0.4, 0.55, 0.6), load=load)
    assert aside.other_body == "the outside of the keep-in zone cell"
    assert aside.distance <= 0.03 + 1e-6


@pytest.mark.parametrize("orientation", [(1.0, 0.0, 0.0, 0.0), TURNED_ORIENTATION])
def test_a_keep_in_zone_is_left_by_the_point_that_is_farthest_out(orientation: tuple[float, ...]) -> None:
    w, _, _, z = orientation
    zone = Shape("cell", "box", (1.4, 1.2, 1.1), (0.3, 0.05, 0.75), orientation=(w, 0.0, 0.0, z))
    model, surface = CollisionModel(Scene("s", floor=-5.0, keep_in=(zone,)), ARM), Surface()
    q = np.random.default_rng(3).uniform(ARM.limits.lower, ARM.limits.upper, (80, 6))
    turn = 2 * np.arctan2(z, w)
    axes = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    sampled = (np.array(zone.size) / 2 - np.abs((surface(q) - np.array(zone.position)) @ axes)).min(axis=(1, 2))
    out = [k for k, row in enumerate(model.clearances(q)) if row.other_body.endswith("cell") and row.distance < 0]
    assert len(out) > 20
    measured = np.array([row.distance for row in model.clearances(q[out])])
    assert np.all(measured <= sampled[out] + 1e-6)
    assert np.all(measured >= sampled[out] - 0.01)  # a rim is drawn with twelve points
