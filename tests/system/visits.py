"""A server that shows a view without a station, and a browser that visits it."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import uvicorn
from fastapi import FastAPI
from scipy.cluster.hierarchy import linkage

from teachpath.access.access import Access
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.settings import AuthSettings
from teachpath.api.events import events_router
from teachpath.api.view import view_router
from teachpath.io import wire
from teachpath.io.documents import to_document
from teachpath.io.memory_bus import MemoryBus
from teachpath.learning.clustering.cuts import dendrogram
from teachpath.live.event_hub import EventHub
from teachpath.live.preview.preview import Preview
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.assessment import assess
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Capability, Cluster, Fit, JointState, Learned, LearnedPath, RunSummary, Task, Trajectory
from teachpath_proto.keys import Keys
from tests.contract.rows import demonstration
from tests.ports import free_port
from tests.waiting import HANG, wait_until

ARM = Arm.of_variant()


KEYS = Keys()


HOME = np.array(MotionSettings().home)


ROBOT = "puma560"


REST = 1e-4  # [m], and of the entries of a rotation: an arm that moves less within a second rests


# How often the view had been drawn ten frames ago, and now.
TEN_FRAMES = """async () => {
  const before = teachpath.draws;
  for (let i = 0; i < 10; i++) await new Promise(requestAnimationFrame);
  return [before, teachpath.draws];
}"""


VERSION = {"number": 1, "branch": "main", "name": "learned", "author": "", "note": "", "parent": None, "created_ns": 1}


class Server:
    """A preview with arm, scene, demonstrations and paths behind a web server that can be restarted."""

    def __init__(self) -> None:
        self.port = free_port()
        self.bus = MemoryBus()

    def start(self, demonstrations: int, arm: Arm = ARM, home: np.ndarray = HOME) -> None:
        self.preview = Preview(self.bus, KEYS, visual_solids(arm), arm=arm, robot=ROBOT, home=home, statuses=list)
        self.preview.show_object(paper_scene().carried)
        self.preview.start()
        app = self.web_app(demonstrations)
        config = uvicorn.Config(app, host="127.0.0.1", port=self.port, log_level="warning", ws="websockets-sansio")
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, daemon=True)
        self._thread.start()
        wait_until(lambda: self._server.started, "the server has started")

    def web_app(self, demonstrations: int) -> FastAPI:
        """The preview, and what the REST API says of a task with so many demonstrations."""
        app = FastAPI()
        app.state.access = Access(AuthSettings(), MemoryTokens(), MemoryPeople())
        app.include_router(view_router(self.preview))
        app.include_router(events_router(EventHub()))
        for resource, document in documents(demonstrations).items():
            app.add_api_route(f"/api/v1/{resource}", lambda document=document: document)
        app.add_api_route("/api/v1/paths/{path}/assessment", look, methods=["POST"])
        return app

    def stop(self) -> None:
        self._server.should_exit = True
        self._thread.join(HANG)
        assert not self._thread.is_alive()
        self.preview.stop()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def publish_state(self, q: np.ndarray, at: tuple[float, float, float]) -> None:
        zero = np.zeros(6)
        state = JointState(1, 1, q, zero, zero, 0.0, 0, False, True, at, (1.0, 0.0, 0.0, 0.0))
        self.bus.publish(KEYS.state(ROBOT), wire.encode_state(state))


def documents(count: int) -> dict[str, Any]:
    """What the REST API says of a task with `count` demonstrations and three ways, without an id in the address."""
    shown = [demonstration(f"d{i}", number=i + 1) for i in range(count)]
    u = np.linspace(0, 1, 100)
    courses = {d.id: Trajectory(u, way(i % 3 + 1).curve(u)) for i, d in enumerate(shown)}
    found = Learned(
        mode="default",
        demonstrations=tuple(courses),
        linkage=linkage(np.arange(count)[:, None]),
        threshold=0.1,
        clusters=tuple(Cluster(k, (), ()) for k in (1, 2, 3)),
        paths=tuple(way(k) for k in (1, 2, 3)),
    )
    return {
        "identity": {"mode": "none", "name": "", "capabilities": list(Capability), "provider": "", "groups": []},
        "tasks": [to_document(Task("t", "paper", "identity", 1))],
        "scenes": [to_document(paper_scene())],
        "executions": [],
        **{f"paths/{path.id}": to_document(path) for path in found.paths},
        **{f"paths/{path.id}/plans": [] for path in found.paths},
        **{f"paths/{path.id}/versions": [VERSION] for path in found.paths},
        **{f"paths/{path.id}/versions/1": {"version": VERSION, "path": to_document(path)} for path in found.paths},
        "tasks/t/jobs": [],
        "tasks/t/runs/run/dendrogram": to_document(dendrogram(found, 30)),
        "tasks/t/demonstrations": [to_document(d) for d in shown],
        "tasks/t/runs": [to_document(RunSummary("run", "t", 1, "default", count, tuple(p.id for p in found.paths)))],
        "tasks/t/runs/run": {"id": "run", "task": "t", "created_ns": 1, "learned": to_document(found)},
        **{f"demonstrations/{key}/trajectory": to_document(course) for key, course in courses.items()},
    }


def look(path: str) -> dict[str, Any]:
    """What the service says of a way when the page asks for a quick look."""
    return to_document(assess(way(int(path[1:])).curve, paper_scene()))


def way(cluster: int) -> LearnedPath:
    points = np.array([[0.5, -0.3, 0.53], [0.25 * cluster, 0.0, 0.55], [0.25 * cluster, 0.1, 0.6], [0.5, 0.3, 0.53]])
    curve = Curve(3, np.array([0, 0, 0, 0, 1, 1, 1, 1.0]), points, np.ones(4))
    return LearnedPath(f"p{cluster}", "run", cluster, 1, curve, Fit(0.0, 0.0, 0.0, 0.0))


# What a page has that does not get ready: what it lacks is not there.
HELD_SCRIPT = """() => {
  const state = Object.entries(globalThis.teachpath?.state() ?? {});
  const lists = state.map(([name, value]) => `${name} ${value?.length ?? JSON.stringify(value)}`);
  return [JSON.stringify(document.documentElement.dataset), ...lists].join(", ").slice(0, 3000);
}"""


class Visit:
    """The page as opened in the browser, with all its console said; without a graphics card every pixel costs.

    Args:
        script: of the page, before its own ones.
        enter: what somebody does on the page before it shows anything, as to sign in.
    """

    def __init__(
        self,
        browser: Any,
        address: str,
        *,
        script: str = "",
        size: tuple[int, int] = (1280, 800),
        enter: Callable[[Any], None] = lambda page: None,
    ) -> None:
        self.page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        self.page.set_default_timeout(1000 * HANG)
        if script:
            self.page.add_init_script(script)
        self.said: list[str] = []
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("response", self._on_response)
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.goto(address)
        enter(self.page)
        try:
            self.page.wait_for_selector("html[data-scene=ready]", state="attached")
            # What the service draws comes another way than what the page does, all of it at once.
            self.page.wait_for_function("() => teachpath.worldMatrix('/robot/link6')", polling=20)
        except Exception as error:
            error.add_note(f"the console said {self.said}; the page holds {self.page.evaluate(HELD_SCRIPT)}")
            raise

    def _on_response(self, answer: Any) -> None:
        if not answer.ok and answer.status != 304:  # what has not changed since the last visit is no fault
            self.said.append(f"{answer.status}: {answer.url}")

    def paths(self) -> list[str]:
        return list(self.page.evaluate("teachpath.objectPaths()"))

    def place(self, path: str) -> np.ndarray:
        """Pose of a path in the world; the page gives three.js's frame, y up."""
        up = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
        return up @ np.reshape(self.page.evaluate(f"teachpath.worldMatrix('{path}')"), (4, 4)).T

    def project(self, point: str) -> tuple[float, float]:
        """Where on the page a point is drawn, given as an expression, once the camera stays where it is."""
        self.page.wait_for_function("() => teachpath.framed()", polling=20)
        x, y = self.page.evaluate(f"() => {{ const {{ editor }} = teachpath; return teachpath.project({point}); }}")
        return float(x), float(y)

    def place_at_rest(self, path: str) -> np.ndarray:
        """Pose of a path in the world, once it has been the same for a second, longer than a stall keeps it back."""
        seen = [self.place(path)]

        def rests() -> bool:
            self.page.wait_for_timeout(100)
            seen.append(self.place(path))
            return len(seen) > 10 and bool(np.ptp(seen[-10:], axis=0).max() < REST)

        self.wait(rests, f"{path} rests")
        return seen[-1]

    def wait(self, true: Callable[[], bool], what: str = "the page shows it") -> None:
        wait_until(true, what, pause=lambda seconds: self.page.wait_for_timeout(5000 * seconds))

    def draws_when_at_rest(self) -> int:
        """How often the view was drawn, once it has not been drawn for ten frames of the browser."""
        counts: list[tuple[int, int]] = [(0, -1)]

        def rests() -> bool:
            counts.append(tuple(self.page.evaluate(TEN_FRAMES)))
            return counts[-1][0] == counts[-1][1]

        self.wait(rests, "the view is not drawn any more")
        return counts[-1][1]
