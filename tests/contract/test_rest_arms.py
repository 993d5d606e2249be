"""Arms that users added, over REST."""

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from tests.contract.desk import Desk, refused


def test_stored_arms_are_listed_and_shown(desk: Desk) -> None:
    for base in ((0.0, 0.0, 0.0), (0.0, 0.0, 0.5)):
        arm = read_arm(EXAMPLES["six-axis"], name="light", base=(base, (1.0, 0.0, 0.0, 0.0)))
        desk.station.store.arms.add(arm, "six_axis.urdf")
    (listed,) = [each for each in desk.get("/arms/stored").json() if each["name"] == "light"]
    assert (listed["version"], listed["hash"], len(listed["joints"])) == (2, arm.hash, 6)
    shown = desk.get("/arms/stored/light").json()
    assert (shown["version"], shown["hash"]) == (2, arm.hash)
    assert shown["arm"]["links"][2]["joint"]["acceleration"] == {"value": 10.0, "source": "default"}
    refused(desk.get("/arms/stored/moon"), 404, "there is no arm 'moon'")
