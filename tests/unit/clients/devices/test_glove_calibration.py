from pathlib import Path
from statistics import fmean

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.errors import ClientError
from tests.unit.clients.devices.readings import calibration

OPEN_READINGS = [[60 + i, *[100] * 3, *[50] * 14] for i in (-1, 0, 1)]
CLOSED_READINGS = [[160 + i, *[40] * 3, *[200] * 11, 51, 50, 49] for i in (-1, 0, 1)]


def test_an_open_hand_is_0_and_a_fist_is_1() -> None:
    made = GloveCalibration.between(OPEN_READINGS, CLOSED_READINGS)
    assert made.flexions(OPEN_READINGS[1]) == (0.0,) * 18
    assert made.flexions(CLOSED_READINGS[1]) == (1.0,) * 18
    assert made.gain[15:] == (0.0, 0.0, 0.0)


@given(raw=st.lists(st.integers(1, 255), min_size=22, max_size=22))
def test_flexions_stay_within_0_and_1_and_their_mean_is_that_of_the_sensors_that_tell(raw: list[int]) -> None:
    made = calibration()
    flexions = made.flexions(raw)
    assert len(flexions) == 22
    assert all(0.0 <= f <= 1.0 for f in flexions)
    telling = [f for f, gain in zip(flexions, made.gain, strict=True) if gain]
    assert fmean(flexions) == pytest.approx(fmean(telling))


@given(flexions=st.lists(st.floats(0.0, 1.0), min_size=18, max_size=18))
def test_raw_is_the_inverse_but_for_a_step(flexions: list[float]) -> None:
    made = calibration(18)
    again = made.flexions(made.raw(flexions))
    for flexion, seen, gain in zip(flexions, again, made.gain, strict=True):
        assert not gain or abs(flexion - seen) <= abs(gain) / 2 + 1e-9


def test_a_file_keeps_every_value(tmp_path: Path) -> None:
    made = GloveCalibration.between(OPEN_READINGS, CLOSED_READINGS)
    made.save(tmp_path / "glove.toml")
    assert GloveCalibration.load(tmp_path / "glove.toml") == made


@pytest.mark.parametrize("text", ["", "offset = 3", "offset = [1.0]\ngain = [1.0]", "offset = ['a']\ngain = []", "]"])
def test_a_file_that_is_none_is_said(tmp_path: Path, text: str) -> None:
    (tmp_path / "glove.toml").write_text(text)
    with pytest.raises(ClientError, match=r"no calibration of a glove|18 or 22 sensors"):
        GloveCalibration.load(tmp_path / "glove.toml")
    with pytest.raises(ClientError, match="make one with teachpath-client glove-calibrate"):
        GloveCalibration.load(tmp_path / "none.toml")


def test_a_hand_that_did_not_close_is_said() -> None:
    with pytest.raises(ClientError, match="0 of 18 sensors tell"):
        GloveCalibration.between(OPEN_READINGS, OPEN_READINGS)
    with pytest.raises(ClientError, match="is it plugged in"):
        GloveCalibration.between(OPEN_READINGS, [])
