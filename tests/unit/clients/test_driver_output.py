"""What a player says of the output that is on."""

from teachpath_client.driver import PlayerState, SetpointPlayer
from tests.unit.clients.test_driver import DELAY, NOW_NS, START, setpoint


def test_an_output_is_on_while_setpoints_with_it_are_played_and_off_as_soon_as_none_is() -> None:
    player = SetpointPlayer(START, delay=DELAY)
    outputs = []
    for ms in range(1000):
        now = NOW_NS + ms * 10**6
        if ms % 4 == 0 and ms < 600:  # then nothing comes any more, in the middle of the motion
            player.add(setpoint(ms // 4, output="glue" if ms >= 200 else ""), now)
        player.advance(0.001, now)
        outputs.append((player.state, player.output))
    assert set(outputs[:200]) == {(PlayerState.PLAYING, "")}
    assert {output for state, output in outputs[300:] if state is PlayerState.PLAYING} == {"glue"}
    assert {output for state, output in outputs if state is not PlayerState.PLAYING} == {""}
    assert outputs[-1] == (PlayerState.STOPPED, "")


def test_whoever_falls_silent_at_rest_leaves_no_output_on() -> None:
    player = SetpointPlayer(START, delay=DELAY)
    on = []
    for ms in range(1000):
        now = NOW_NS + ms * 10**6
        if ms % 4 == 0 and ms < 400:  # all at rest, where the motion has not begun
            player.add(setpoint(ms // 4, start=-10.0, output="torch"), now)
        player.advance(0.001, now)
        on.append(player.output == "torch")
    assert all(on[100:400])
    assert not any(on[600:])
    assert player.state is PlayerState.PLAYING
    player.add(setpoint(100, start=-10.0, output="torch"), NOW_NS + 10**9)
    player.advance(0.2, NOW_NS + 10**9)
    assert player.output == "torch"
