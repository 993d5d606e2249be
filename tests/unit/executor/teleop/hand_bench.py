"""A bench whose arm follows a live hand."""

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.io.documents import encode
from teachpath.io.wire import encode_sample
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.records import Calibration, TeleopRequest
from tests.unit.executor.executors import HOME, KEYS, PERIOD_NS, Bench
from tests.unit.recording.hands import sample

ARM = Arm.of_variant()


CLUTCH = 4


ORDER = TeleopRequest("glove", Calibration("identity"), "empty")


class Held(Bench):
    """A bench with a hand that is shown 50 times a second."""

    def __init__(self, hand_scene: str = "") -> None:
        super().__init__(hand_scene=hand_scene)
        self.hand, self.buttons, self.shown, self.number = np.zeros(3), 0, True, 0
        self.turn: Rotation | None = Rotation.identity()  # of the hand; None: it is not measured
        self.session = "this process"  # that sends the hand's samples
        self.intruder: np.ndarray | None = None  # hand of another session, that presses the clutch too
        self.page: int | None = None  # buttons of a page that looks on; None: there is none

    def sleep(self, duration: float) -> None:
        if self.now // PERIOD_NS % 5 == 0:
            self.number += 1
            if self.shown:
                self.show("glove", self.hand, self.buttons)
            if self.intruder is not None:
                self.show("glove", self.intruder, CLUTCH, "theirs")
            if self.page is not None:
                self.show("page", np.ones(3), self.page)
        super().sleep(duration)

    def show(self, tracker: str, hand: np.ndarray, buttons: int, source: str = "") -> None:
        turn = None if self.turn is None else tuple(self.turn.as_quat(scalar_first=True).tolist())
        shown = sample(self.number, tuple(hand), buttons=buttons, orientation=turn)
        self.bus.publish(KEYS.samples(tracker), encode_sample(shown), source=source or self.session)

    def press(self) -> None:
        self.buttons = CLUTCH

    def teleoperate(self, order: TeleopRequest = ORDER) -> None:
        self.when(lambda: self.now > PERIOD_NS, lambda: self.command("teleoperate", teleop=encode(order)))
        self.when(lambda: self.statuses[-1].awaits_clutch, lambda: None)
        self.after(0.1)
        self.when(lambda: True, self.press)

    def after(self, seconds: float) -> None:
        """Let time pass."""
        until: list[int] = []
        self.when(lambda: True, lambda: until.append(self.now + round(seconds * 1e9)))
        self.when(lambda: self.now > until[0], lambda: None)


def moved(bench: Held) -> np.ndarray:
    return tool_pose(bench.setpoints[-1].position, ARM)[:3, 3] - tool_pose(HOME, ARM)[:3, 3]
