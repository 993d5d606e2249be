"""The pedal: a key of a terminal over a real pty, and the kernel's input events through a pipe that stands for one."""

import os
import pty
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath_client.__main__ import main
from teachpath_client.errors import ClientError
from teachpath_client.pedal import EVENT, KEY_EVENT, PEDAL_BIT, EventPedal, TerminalPedal, open_pedal, with_pedal
from teachpath_client.reading import HandReading
from teachpath_client.terminal import PosixTerminal, WindowsConsole
from tests.unit.clients.devices.readings import readings, until


@pytest.fixture
def terminal() -> Iterator[tuple[int, int]]:
    """A terminal: the end that a person types into, and the end that the program reads."""
    typed, read = pty.openpty()
    yield typed, read
    os.close(typed)
    os.close(read)


@pytest.fixture
def device(tmp_path: Path) -> Iterator[tuple[Path, int]]:
    """An input device, and where its events are written."""
    file = tmp_path / "event5"
    os.mkfifo(file)
    fd = os.open(file, os.O_RDWR)
    yield file, fd
    os.close(fd)


def event(value: int, code: int = 57, kind: int = KEY_EVENT) -> bytes:
    return EVENT.pack(0, 0, kind, code, value)


@pytest.mark.parametrize(("key", "typed"), [("space", b" "), ("enter", b"\r"), ("b", b"xyb")])
def test_a_key_of_the_terminal_is_held_for_a_moment(terminal: tuple[int, int], key: str, typed: bytes) -> None:
    now = [0.0]
    with TerminalPedal(key, terminal=PosixTerminal(terminal[1]), clock=lambda: now[0]) as pedal:
        os.write(terminal[0], b"q")
        assert not pedal.is_down
        os.write(terminal[0], typed)
        until(lambda: pedal.is_down, "the key is down")
        now[0] = 0.2
        assert not pedal.is_down


def test_the_terminal_is_left_as_it_was_and_ctrl_c_works_meanwhile(terminal: tuple[int, int]) -> None:
    before = termios.tcgetattr(terminal[1])
    with TerminalPedal("space", terminal=PosixTerminal(terminal[1])):
        assert termios.tcgetattr(terminal[1])[3] & termios.ISIG
        assert not termios.tcgetattr(terminal[1])[3] & (termios.ICANON | termios.ECHO)
    assert termios.tcgetattr(terminal[1]) == before


class Typed:
    """A Windows console on which all this was typed."""

    def __init__(self, *keys: bytes) -> None:
        self._bytes = [key[i : i + 1] for key in keys for i in range(len(key))]

    def kbhit(self) -> bool:
        return bool(self._bytes)

    def getch(self) -> bytes:
        return self._bytes.pop(0)


def test_a_windows_console_gives_keys_one_by_one_and_no_code_of_a_key_without_a_character() -> None:
    now = [0.0]

    def sleep(seconds: float) -> None:
        now[0] += seconds

    up = b"\xe0H"
    with WindowsConsole(Typed(b"b", up, b" "), is_console=True, sleep=sleep, clock=lambda: now[0]) as console:
        assert [console.read(0.1) for _ in range(4)] == [b"b", b"", b" ", b""]
    assert 0.1 <= now[0] < 0.2


def test_a_key_of_a_windows_console_is_a_pedal() -> None:
    with TerminalPedal("enter", terminal=WindowsConsole(Typed(b"b\r"), is_console=True), clock=lambda: 0.0) as pedal:
        until(lambda: pedal.is_down, "Enter was typed")


def test_a_device_is_down_from_press_to_release(device: tuple[Path, int]) -> None:
    file, fd = device
    with EventPedal(str(file)) as pedal:
        os.write(fd, event(1) + event(2) + event(0, kind=0))
        until(lambda: pedal.is_down, "it is down, and a repeat or another kind of event does not change that")
        os.write(fd, event(1, code=30) + event(0))
        until(lambda: pedal.is_down, "one of two keys is still down")
        os.write(fd, event(0, code=30)[:10])
        os.write(fd, event(0, code=30)[10:])  # in two pieces
        until(lambda: not pedal.is_down, "it is up")


def test_the_bit_is_in_the_readings_while_it_is_down() -> None:
    class Pressed:
        is_down = False

    pedal, got = Pressed(), []
    stream = with_pedal(iter([HandReading(r.time, r.position, buttons=1) for r in readings(6)]), pedal)
    for down in (False, True, True, False, False, True):
        pedal.is_down = down
        got.append(next(stream).buttons)
    assert got == [1, 1 | PEDAL_BIT, 1 | PEDAL_BIT, 1, 1, 1 | PEDAL_BIT]


def test_what_is_no_pedal_is_said(tmp_path: Path) -> None:
    with pytest.raises(ClientError, match="--pedal spcae is no key: name space, enter, tab, a letter"):
        open_pedal("spcae")
    with pytest.raises(ClientError, match="No such file or directory; is it plugged in"):
        open_pedal(str(tmp_path / "none")).__enter__()
    read, write = os.pipe()
    with pytest.raises(ClientError, match="needs a terminal"):
        TerminalPedal("space", terminal=PosixTerminal(read)).__enter__()
    os.close(read)
    os.close(write)
    with pytest.raises(ClientError, match="needs a terminal"):
        TerminalPedal("space", terminal=WindowsConsole(Typed(), is_console=False)).__enter__()
    with pytest.raises(SystemExit):
        main(["tracker", "--source", "synthetic", "--takes", "-1"])
