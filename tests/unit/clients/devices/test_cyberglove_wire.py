import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath_client.devices.cyberglove_wire import GloveParser, period, vibration, write_sample

LETTERS = pytest.mark.parametrize("letter", [b"S", b"G", b"s", b"g"])
RAW_READINGS = st.lists(st.integers(1, 255), min_size=22, max_size=22).map(tuple)


def found(wire: bytes, sensors: int = 22, size: int = 10**6) -> list[tuple[int, ...]]:
    reader = GloveParser(sensors)
    return [sample for i in range(0, len(wire), size) for sample, _ in reader.feed(wire[i : i + size])]


def test_a_sample_of_a_public_transcript_is_read() -> None:
    text = b"g 1 76 93 113 89 42 20 77 98 106 117 81 62 23 52 60 34 68 57 254 92 26"
    values = tuple(map(int, text.split()[1:]))
    for end in (b"\r\n\0", b"\n\0", b"\0"):
        assert found(text + end) == [values]
    assert found(b"G" + bytes(values) + b"\0") == [values]


def test_commands_have_the_bytes_of_the_drivers() -> None:
    assert period(100.0) == b"t 1152 1\r"
    assert period(45.0) == b"t 2560 1\r"
    assert period(10.0) == b"t 11520 1\r"
    assert vibration(128) == b"A\xff\x80\x80\x80\x80\x80\x80"


@LETTERS
@settings(max_examples=100, deadline=None)
@given(samples=st.lists(RAW_READINGS, min_size=1, max_size=5), size=st.integers(1, 200))
def test_whole_samples_come_out_in_order_whatever_the_pieces(
    letter: bytes, samples: list[tuple[int, ...]], size: int
) -> None:
    assert found(b"".join(write_sample(letter, raw) for raw in samples), size=size) == samples


@LETTERS
@settings(max_examples=200, deadline=None)
@given(noise=st.binary(max_size=200), samples=st.lists(RAW_READINGS, min_size=2, max_size=4), size=st.integers(1, 200))
def test_after_noise_every_whole_sample_comes_out(
    letter: bytes, noise: bytes, samples: list[tuple[int, ...]], size: int
) -> None:
    wire = noise + b"".join(write_sample(letter, raw) for raw in samples)
    again = found(wire, size=size)
    assert again[-len(samples) + 1 :] == samples[1:]


@settings(max_examples=200, deadline=None)
@given(raw=RAW_READINGS, other=RAW_READINGS, cut=st.integers(0, 22))
def test_a_torn_sample_spoils_no_whole_one(raw: tuple[int, ...], other: tuple[int, ...], cut: int) -> None:
    assert found(write_sample(b"S", raw)[:cut] + write_sample(b"S", other)) == [other]
    assert found(write_sample(b"S", raw)[1 + cut :] + write_sample(b"S", other))[-1:] == [other]


@settings(max_examples=300, deadline=None)
@given(wire=st.binary(max_size=400), sensors=st.sampled_from([18, 22]), size=st.integers(1, 100))
def test_no_bytes_raise_and_no_sensor_is_zero(wire: bytes, sensors: int, size: int) -> None:
    for sample in found(wire, sensors, size):
        assert len(sample) == sensors
        assert all(1 <= value <= 255 for value in sample)


def test_answers_between_samples_are_no_samples() -> None:
    raw = tuple(range(1, 19))
    wire = b"A\0" + write_sample(b"G", raw) + b"?G\x03\0e?\0" + write_sample(b"G", raw)
    assert found(wire, 18) == [raw, raw]


@pytest.mark.parametrize("letter", [b"S", b"G"])
@pytest.mark.parametrize("error", [b"eg", b"es"])
@pytest.mark.parametrize("second", [1, ord("S"), ord("G")])  # what a sample begins with may stand within one
def test_a_sample_that_was_not_measured_is_none(letter: bytes, error: bytes, second: int) -> None:
    raw = (7, second, *range(3, 19))
    failed = letter + bytes(raw) + error + b"\0"
    assert found(write_sample(letter, raw) + failed + write_sample(letter, raw), 18) == [raw, raw]
