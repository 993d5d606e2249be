"""The object's mass is one number: for the dynamics of plans and of the live hand, and for the simulated arm."""

import hashlib
from dataclasses import replace
from itertools import product

import mujoco
import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.io.documents import from_document, to_document
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.mjcf import CARRIED_BODY, write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.object_mass import OBJECT_DENSITY, object_mass
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.canonical import canonical
from teachpath.motion.planning.digest import digest
from teachpath.motion.planning.plan import plan
from teachpath.records import Plan, Scene, Shape
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()
CORNERS = tuple(product((0.0, 40.0), (0.0, 30.0), (0.0, 20.0)))  # mm
PLACE = (0.5, 0.1, 0.55)
SHAPES = (
    (Shape("box", "box", (0.04, 0.03, 0.02), PLACE), 0.04 * 0.03 * 0.02),
    (Shape("can", "cylinder", (0.02, 0.06), PLACE), np.pi * 0.02**2 * 0.06),
    (Shape("ball", "sphere", (0.02,), PLACE), 4 / 3 * np.pi * 0.02**3),
    (Shape("case", "mesh", (0.001,), PLACE, vertices=CORNERS), 0.04 * 0.03 * 0.02),
)
STORED_DIGEST = (
    "0ade6ad1e6c210cc6c2ce4edc418f96f8e7a8eb1f0f030a5b85c88a5ddfc79a2"  # of the scene, before objects had a mass
)
PAPER = paper_scene()


def of_mass(mass: float | None) -> Scene:
    assert PAPER.carried
    return replace(PAPER, carried=replace(PAPER.carried, mass=mass))


@pytest.mark.parametrize(("shape", "volume"), SHAPES, ids=lambda value: getattr(value, "kind", ""))
def test_it_is_what_the_scene_says_else_that_of_the_volume_also_where_it_is_simulated(
    shape: Shape, volume: float
) -> None:
    for mass in (None, 0.7):
        said = replace(shape, mass=mass)
        assert object_mass(said) == pytest.approx(OBJECT_DENSITY * volume if mass is None else mass)
        model = mujoco.MjModel.from_xml_string(write_mjcf(Scene("s", carried=said), ARM))
        assert model.body(CARRIED_BODY).mass == pytest.approx(object_mass(said))


def test_a_scene_that_says_no_mass_keeps_its_digest_and_every_mass_has_one_of_its_own() -> None:
    document = to_document(PAPER)
    for shape in (*document["obstacles"], document["carried"]):
        del shape["mass"]
    assert from_document(Scene, document) == PAPER
    digests = [hashlib.sha256(canonical(of_mass(mass))).hexdigest() for mass in (None, 0.0192, 0.5)]
    assert digests[0] == STORED_DIGEST
    assert len(set(digests)) == 3


def test_the_torques_grow_by_what_the_mass_asks_for() -> None:
    rng = np.random.default_rng(3)
    q = rng.uniform(ARM.limits.lower, ARM.limits.upper, (20, 6))
    motion = (q, rng.uniform(-1, 1, (20, 6)), rng.uniform(-4, 4, (20, 6)))
    bare, *held = (Dynamics(ARM, replace(SHAPES[0][0], mass=m)).torques(*motion) for m in (1e-4, 1.0, 2.0))
    np.testing.assert_allclose(held[1] - bare, (2.0 - 1e-4) / (1.0 - 1e-4) * (held[0] - bare), atol=1e-9)
    assert np.abs(held[0] - bare).max() > 3.0  # [N m]


@pytest.fixture(scope="module")
def paper_plan() -> Plan:
    return plan(way(MIDDLE), PAPER)


def test_a_plan_is_for_one_mass_and_one_that_is_too_heavy_is_refused_by_it(paper_plan: Plan) -> None:
    heavy = plan(way(MIDDLE), of_mass(2.0))
    uses = [each.certificate.torque_use.value for each in (paper_plan, heavy)]
    assert uses[0] < uses[1] <= 1.0
    other = replace(heavy, scene=of_mass(2.1))
    assert len({digest(each, ARM) for each in (paper_plan, heavy, other)}) == 3
    with pytest.raises(PathRefused, match=r"carry less \(the object has 40 kg\)"):
        plan(way(MIDDLE), of_mass(40.0))


def test_the_simulated_arm_holds_the_weight_that_plans_are_proved_with(paper_plan: Plan) -> None:
    still, q = np.zeros(6), paper_plan.joints[0]
    lifted, masses = q + np.array([0.0, 0.15, 0.0, 0.0, 0.0, 0.0]), (None, 2.0)
    held, needed = np.empty((2, 6)), np.empty((2, 6))
    for row, scene in enumerate(map(of_mass, masses)):
        arm = SimulatedArm(scene, ARM, SimulatorSettings(), q)
        for _ in range(20):
            arm.step(q, still, still)
        assert arm.grasp()
        for share in np.linspace(0.0, 1.0, 1000):
            arm.step(q + share * (lifted - q), still, still)
        for _ in range(1000):
            arm.step(lifted, still, still)
        np.testing.assert_allclose(arm.position, lifted, atol=1e-3)
        dynamics = Dynamics(ARM, scene.carried)
        held[row], needed[row] = arm.torque, dynamics.torques(lifted[None], still[None], still[None])[0]
    assert needed[1, 1] - needed[0, 1] > 10.0  # [N m] 2 kg, more than 0.5 m from the axis of joint 2
    np.testing.assert_allclose(held[1] - held[0], needed[1] - needed[0], atol=0.5)  # friction bears some of it
