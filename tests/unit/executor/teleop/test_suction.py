"""A live hand and a suction cup: nobody checks how the cup comes upon an object."""

import pytest

from teachpath.errors import PathRefused
from teachpath.io.documents import encode
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration, TeleopRequest
from tests.unit.executor.executors import Bench


def test_no_live_hand_leads_a_suction_cup_where_an_object_stands() -> None:
    settings = MotionSettings(gripper="suction")
    bench = Bench(motion=settings, arm=Arm.of_settings(settings))

    def refuse() -> None:
        with pytest.raises(PathRefused, match="a suction cup in scenes without an object alone, and paper has block"):
            bench.command("teleoperate", teleop=encode(TeleopRequest("glove", Calibration("identity"), "paper")))

    bench.when(lambda: bool(bench.statuses), refuse)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert bench.setpoints == []
