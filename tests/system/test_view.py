"""The page and its 3-D view in headless Chromium: what is shown, what moves, what comes back, what is refused."""

import io
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.kinematics import link_frames
from tests.system.visits import ARM, HOME, Server, Visit
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system


@pytest.fixture
def server() -> Iterator[Server]:
    server = Server()
    server.start(demonstrations=12)
    yield server
    server.stop()


@pytest.fixture
def visit(browser: Any, server: Server) -> Iterator[Visit]:
    visit = Visit(browser, server.address)
    yield visit
    visit.page.close()


def test_shows_arm_obstacles_paths_and_demonstrations_with_a_clean_console(visit: Visit) -> None:
    paths = visit.paths()
    assert {"/scene/table", "/scene/box", "/scene/cylinder", "/object"} <= set(paths)
    assert [p for p in paths if p.startswith("/paths/")] == ["/paths/p1", "/paths/p2", "/paths/p3"]
    assert [p for p in paths if p.startswith(("/marks/", "/names/"))] == [
        f"/{kind}/p{k}" for kind in ("marks", "names") for k in (1, 2, 3)
    ]
    assert len([p for p in paths if p.startswith("/demonstrations/")]) == 12
    assert len([p for p in paths if p.startswith("/robot/link")]) == len(visual_solids())
    picture = np.asarray(Image.open(io.BytesIO(visit.page.screenshot())).convert("L"), dtype=float)
    assert picture[100:700, 50:850].std() > 10  # a blank canvas has 0
    visit.page.wait_for_timeout(500)  # the panels have asked
    visit.wait(lambda: visit.page.locator("#connection").text_content() == "Connected")
    assert visit.said == []


def test_the_arm_and_what_it_carries_move_and_then_the_page_rests(visit: Visit, server: Server) -> None:
    goal = HOME + np.array([0.5, -0.3, 0.3, 0.2, 0.2, 0.4])
    assert np.allclose(visit.place("/robot/link6"), link_frames(HOME, ARM)[6], atol=1e-4)
    for share in np.linspace(0, 1, 20):
        server.publish_state(HOME + share * (goal - HOME), (0.4, 0.1, 0.5 + share / 10))
        visit.page.wait_for_timeout(20)
    visit.wait(lambda: np.allclose(visit.place("/robot/link6"), link_frames(goal, ARM)[6], atol=1e-4))
    visit.wait(lambda: np.allclose(visit.place("/object")[:3, 3], (0.4, 0.1, 0.6), atol=1e-4))

    def rests() -> bool:
        drawn = visit.draws_when_at_rest()
        for _ in range(20):
            server.publish_state(goal, (0.4, 0.1, 0.6))
            visit.page.wait_for_timeout(20)
        return bool(visit.page.evaluate("teachpath.draws") == drawn)

    visit.wait(rests, "states that change nothing draw nothing")  # what was late before may be drawn once


def test_comes_back_after_a_restart_and_shows_the_truth(visit: Visit, server: Server) -> None:
    server.stop()
    visit.page.wait_for_selector("html[data-connection=lost]", state="attached")
    server.start(demonstrations=3)
    visit.page.wait_for_selector("html[data-connection=live][data-events=live]", state="attached")
    visit.wait(lambda: len([p for p in visit.paths() if p.startswith("/demonstrations/")]) == 3)
    visit.wait(lambda: len([p for p in visit.paths() if p.startswith("/robot/link")]) == len(visual_solids()))
    assert visit.page.evaluate("teachpath.stand()") == 0  # it stands on the floor


def test_every_demonstration_of_many_can_be_reached(visit: Visit, server: Server) -> None:
    server.stop()
    server.start(demonstrations=130)
    numbers = visit.page.locator("#demonstrations .demonstration-list .number")
    visit.wait(lambda: numbers.all_inner_texts() == [str(number) for number in range(130, 70, -1)])
    visit.page.get_by_role("button", name="Last page").click()
    assert numbers.all_inner_texts() == [str(number) for number in range(10, 0, -1)]
    visit.page.get_by_label("Order of demonstrations").select_option("oldest")
    assert numbers.all_inner_texts() == [str(number) for number in range(1, 61)]
    visit.page.get_by_label("Search demonstrations").fill("125")
    assert numbers.all_inner_texts() == ["125"]


def test_what_is_cleared_disappears_and_layers_can_be_hidden(visit: Visit, server: Server) -> None:
    server.preview.clear("/object")
    visit.wait(lambda: not any(p.startswith("/object") for p in visit.paths()))
    before = visit.page.screenshot()
    visit.page.get_by_label("learned paths").uncheck()
    visit.wait(lambda: visit.page.screenshot() != before)


def test_a_foreign_page_is_refused(server: Server) -> None:
    address = f"ws://127.0.0.1:{server.port}/api/v1/view"
    for origin in ("http://elsewhere.example", "null"):
        with pytest.raises(InvalidStatus) as refused:
            connect(address, origin=origin)  # type: ignore[arg-type]
        assert refused.value.response.status_code == 403
    with connect(address, origin=server.address) as own, connect(address) as program:  # type: ignore[arg-type]
        assert isinstance(own.recv(timeout=HANG), bytes)
        assert isinstance(program.recv(timeout=HANG), bytes)


def test_a_page_that_talks_nonsense_is_closed_and_the_others_stay(server: Server) -> None:
    address = f"ws://127.0.0.1:{server.port}/api/v1/view"
    with connect(address) as good, connect(address) as bad:
        good.recv(timeout=HANG)
        bad.recv(timeout=HANG)
        bad.send(b"\xff")
        wait_until(lambda: bad.state.name == "CLOSED", "the page is closed")
        good.send("1")
        server.preview.clear("/object")
        assert isinstance(good.recv(timeout=HANG), bytes)


def test_files_come_with_a_strict_policy_and_nothing_else_comes(server: Server) -> None:
    with httpx.Client(base_url=server.address, timeout=HANG) as client:
        page = client.get("/")
        policy = page.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "<script>" not in page.text
        module = client.get("/web/view.js")
        assert module.headers["content-type"].startswith("text/javascript")
        assert module.headers["content-encoding"] == "gzip"
        assert client.get("/web/view.js", headers={"If-None-Match": module.headers["etag"]}).status_code == 304
        assert client.get("/web/view.js", headers={"If-None-Match": '"x"', "Accept-Encoding": ""}).text == module.text
        assert "MIT" in client.get("/vendor/meshcat.LICENSE.txt").text
        assert client.get("/vendor/meshcat.min.js").headers["x-content-type-options"] == "nosniff"
        assert client.get("/favicon.ico").status_code == 200
        for path in ("/web/none.js", "/web/..%2F..%2Fpyproject.toml", "/web/%2Fetc%2Fpasswd", "/vendor/index.html"):
            assert client.get(path).status_code == 404
