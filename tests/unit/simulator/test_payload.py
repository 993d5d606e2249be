"""The simulated arm carries the payload: its motors hold the weight that the dynamics of plans tells of."""

from dataclasses import replace

import numpy as np

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm, Payload
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.settings import MotionSettings
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings

HOME, HOME_AT_REST = np.array(MotionSettings().home), np.zeros(6)


def test_it_holds_its_payload() -> None:
    bare = Arm.of_variant()
    held = {}
    for arm in (bare, replace(bare, payload=Payload(3.0, (0.05, 0.0, 0.2)))):
        simulated = SimulatedArm(empty_scene(), arm, SimulatorSettings(), HOME)
        for _ in range(300):
            simulated.step(HOME, HOME_AT_REST, HOME_AT_REST)
        needed = Dynamics(arm).torques(HOME[None], HOME_AT_REST[None], HOME_AT_REST[None])[0]
        np.testing.assert_allclose(simulated.torque, needed, atol=0.05)
        np.testing.assert_allclose(simulated.position, HOME, atol=1e-3)
        held[arm] = simulated.torque
    assert held[bare][1] + 10.0 < held[arm][1]  # 3 kg, more than 0.35 m from the axis of joint 2
