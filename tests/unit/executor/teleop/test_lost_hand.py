"""The clutch of a live hand, and a hand or page that is lost for a moment."""

from dataclasses import replace

import numpy as np
import pytest

from tests.unit.executor.executors import standing, within_limits
from tests.unit.executor.teleop.hand_bench import CLUTCH, ORDER, Held, moved


def test_the_arm_follows_while_the_clutch_is_pressed_and_a_lost_hand_needs_it_again() -> None:
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: setattr(bench, "shown", False))
    bench.when(lambda: "the hand was lost" in bench.statuses[-1].reason, lambda: setattr(bench, "hand", np.ones(3)))
    bench.when(lambda: True, lambda: setattr(bench, "shown", True))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen, [[0.0, 0.05, 0.03]] * 2, atol=1e-5)
    assert bench.states() == ["idle", "held", "following", "held", "ended"]
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)
    assert (bench.statuses[-1].hand, bench.statuses[-1].hand_scene) == ("glove", "empty")
    assert 0 < bench.statuses[-1].hand_latency_p50_us <= bench.statuses[-1].hand_latency_p99_us <= 40_000


@pytest.mark.parametrize(("left", "why"), [(0, "press the clutch"), (None, "nothing was heard of page")])
def test_a_page_that_looks_on_presses_the_clutch_and_letting_go_or_leaving_holds_the_arm(
    left: int | None, why: str
) -> None:
    bench, seen = Held(), []
    bench.page = 0
    bench.teleoperate(replace(ORDER, clutch="page"))
    bench.after(0.3)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))  # the hand's own button is no clutch now
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "page", CLUTCH))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(2.0)
    bench.when(lambda: True, lambda: setattr(bench, "page", left))
    bench.when(lambda: why in bench.statuses[-1].reason, lambda: setattr(bench, "hand", np.ones(3)))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen, [np.zeros(3), [0.0, 0.05, 0.03]], atol=1e-5)
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


def led_to(place: list[float]) -> tuple[Held, list[np.ndarray]]:
    """Return a bench whose hand leads the arm to a place and is lost there, and what `moved` was then."""
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array(place)))
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    return bench, seen


def ended(bench: Held, seen: list[np.ndarray]) -> None:
    """Let the bench run on for a while, then stop it."""
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize(
    ("away", "place", "buttons", "words"),
    [
        (0.5, [0.0, 0.07, 0.05], CLUTCH, ""),
        (0.5, [0.0, 0.2, 0.05], CLUTCH, "the hand moved too far"),
        (0.5, [0.0, 0.07, 0.05], 0, "press the clutch"),
        (2.0, [0.0, 0.05, 0.03], CLUTCH, "let the clutch go"),
    ],
)
def test_a_hand_that_is_lost_for_a_moment_is_followed_on_and_any_other_needs_its_clutch_again(
    away: float, place: list[float], buttons: int, words: str
) -> None:
    bench, seen = led_to([0.0, 0.05, 0.03])
    bench.when(lambda: True, lambda: setattr(bench, "shown", False))
    bench.when(lambda: "goes on by itself" in bench.statuses[-1].reason, lambda: None)
    bench.after(away)
    bench.when(lambda: True, lambda: setattr(bench, "hand", np.array(place)))
    bench.when(lambda: True, lambda: setattr(bench, "buttons", buttons))
    bench.when(lambda: True, lambda: setattr(bench, "shown", True))
    says: list[str] = []
    bench.after(1.0)
    waits: list[bool] = []
    bench.when(lambda: True, lambda: says.append(bench.statuses[-1].reason))
    bench.when(lambda: True, lambda: waits.append(bench.statuses[-1].awaits_clutch))
    ended(bench, seen)
    assert words in says[0]
    assert waits == [words == "press the clutch"]
    assert bench.states() == ["idle", "held", "following", "held", *["following"] * (words == ""), "ended"]
    np.testing.assert_allclose(seen, [[0.0, 0.05, 0.03], [0.0, 0.05, 0.03] if words else place], atol=1e-5)


def test_a_page_that_presses_the_clutch_and_is_gone_for_a_moment_goes_on_leading() -> None:
    bench, seen = Held(), []
    bench.page = 0
    bench.teleoperate(replace(ORDER, clutch="page"))
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "page", CLUTCH))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "page", None))
    bench.when(lambda: "nothing was heard of page" in bench.statuses[-1].reason, lambda: None)
    bench.when(lambda: True, lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))  # it waits for the page, whatever the hand does
    bench.when(lambda: True, lambda: setattr(bench, "page", CLUTCH))
    ended(bench, seen)
    np.testing.assert_allclose(seen, [np.zeros(3), [0.0, 0.05, 0.03]], atol=1e-5)


def test_an_arm_that_was_late_goes_on_behind_its_hand() -> None:
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.07, 0.03])))
    bench.after(0.1)
    bench.when(lambda: True, lambda: setattr(bench, "pace", 0.02))
    bench.when(lambda: "the arm is late" in bench.statuses[-1].reason, lambda: setattr(bench, "pace", 3.0))
    ended(bench, seen)
    assert "following" in bench.states()[bench.states().index("following") + 1 :]
    np.testing.assert_allclose(seen[-1], [0.0, 0.07, 0.03], atol=1e-5)
