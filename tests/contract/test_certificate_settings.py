"""Which settings of certificates contradict each other."""

import pytest

from teachpath.errors import UnusableSettings
from teachpath.io.bus_logins import prepare_access
from teachpath.io.bus_settings import BusSettings


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (BusSettings(mode="client"), "a router knows programs by their certificates"),
        (BusSettings("tls/127.0.0.1:1", access_control=False), "certificates say who may do what; set it to true"),
    ],
)
def test_settings_that_contradict_each_other_are_refused(settings: BusSettings, sentence: str) -> None:
    with pytest.raises(UnusableSettings, match=sentence):
        prepare_access(settings)
