"""Executions: move the arm along a certified plan, and control the motion."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Final, Literal

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Header, Query, Response
from fastapi.responses import FileResponse
from pydantic import AfterValidator, Field

from teachpath.api.access import MAX_HEADER_LENGTH, NO_CAPABILITY, OPERATE, VIEW, Sender, Who, signed
from teachpath.api.answers import MCAP, files, located, model_of
from teachpath.api.names import TrackerName, TrackerNameOrEmpty
from teachpath.api.pages import WantedPage
from teachpath.api.parts import MAX_READERS, Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.errors import UnusableInput
from teachpath.io.store.lists import Execution
from teachpath.motion.analysis.time_series import TimeSeries
from teachpath.records import Command, ExecutorStatus, TeleopRequest
from teachpath.robot.executions import Executions, encode_series
from teachpath_proto.control import CommandVerb

MAX_STOPS: Final = 100  # that wait for the executor at a time
Token = Annotated[
    str,
    Header(
        alias="Teachpath-Lease",
        max_length=MAX_HEADER_LENGTH,
        description="token of POST /lease, when somebody holds control",
    ),
]
# Of a stop, which is never refused for what comes with it: cut to what the journal can hold.
AnyLabel = Annotated[
    str,
    Header(alias="Teachpath-Operator", description="your name, for the journal"),
    AfterValidator(lambda name: "".join(filter(str.isprintable, name))[:MAX_HEADER_LENGTH]),
]
AnyToken = Annotated[
    str,
    Header(alias="Teachpath-Lease", description="token of POST /lease, when somebody holds control"),
    AfterValidator(lambda token: token[:MAX_HEADER_LENGTH]),
]


class NewExecution(Body):
    """A plan to execute."""

    plan: str = Field(description="id of a plan; only a plan with a valid certificate moves the arm")
    override: float = Field(1.0, ge=0.0, le=1.0, description="share of the planned speed")


class NewTeleoperation(Body):
    """A live hand for the arm to mirror."""

    tracker: TrackerName = Field(description="name of the tracker")
    calibration: str = Field("identity", description="to the world from the tracker's frame")
    scene: str = Field(
        "", description="what stands around the arm; left out: `executor.hand_scene`, or paper where that is empty"
    )
    scale: float = Field(1.0, ge=0.05, le=5.0, description="of the tool's way over the hand's")
    share: float = Field(0.5, ge=0.05, le=1.0, description="of the joints' speed, acceleration and jerk limits")
    clutch: TrackerNameOrEmpty = Field(
        "", description="tracker whose button bit 2 is the clutch, e.g. that of a page; empty: the hand's own"
    )
    orientation: Literal["keep", "follow"] | None = Field(
        None,
        description="whether the tool keeps its orientation or turns with the hand; left out: as the settings say",
    )


class Override(Body):
    """A speed override."""

    override: float = Field(ge=0.0, le=1.0, description="share of the planned speed")


class Step(Body):
    """A step on the path, of one kind."""

    length: float | None = Field(None, ge=-10.0, le=10.0, description="metres along the path; negative is back")
    nodes: int | None = Field(None, ge=-10_000, le=10_000, description="nodes of the plan; negative is back")


def executions_router(parts: Parts) -> APIRouter:
    """Return the routes of executions."""
    router = APIRouter(tags=["executions"])
    _add_beginnings(router, parts)
    _add_looks(router, parts)
    _add_steering(router, parts.executions)
    return router


def _add_beginnings(router: APIRouter, parts: Parts) -> None:
    executions = parts.executions

    @router.post(
        "/executions",
        status_code=202,
        responses=refusals(409, 507) | located(202, "the execution"),
        dependencies=OPERATE,
    )
    def begin_execution(new: NewExecution, response: Response, who: Who, lease: Token = "") -> Execution:
        """Move the arm: approach, grasp, follow the path, release, retreat."""
        with named_in_body("plan"):
            row = executions.execute(new.plan, override=new.override, lease=lease, who=who)
        response.headers["Location"] = f"/api/v1/executions/{row.id}"
        return row

    @router.post(
        "/teleoperation",
        status_code=202,
        responses=refusals(409, 507) | located(202, "the execution"),
        dependencies=OPERATE,
    )
    def begin_teleoperation(new: NewTeleoperation, response: Response, who: Who, lease: Token = "") -> Execution:
        """Let the arm mirror a live hand while its clutch (button bit 2) is pressed; steer and stop it as an execution.

        The clutch may be another tracker's: whoever looks on presses it then, and lets go to hold the arm. Both names
        belong to the sessions on the bus that send under them now; the arm follows nobody else who uses them.

        The tool keeps its orientation on the whole way, or turns as the hand has turned since the clutch was pressed;
        the gripper closes and opens with the hand, or with its grasp button (bit 0). Where the arm cannot do both, a
        tool that keeps its orientation stays short of the hand, and one that turns with the hand turns less first.
        The arm keeps its limits, it and what it carries stay clear of the scene, and all rests when the clutch is let
        go or the hand is lost.
        """
        with named_in_body("calibration"):
            calibration = parts.calibrations.get(new.calibration)
        with named_in_body("scene"):
            scene = parts.objects.scene(new.scene or parts.settings.executor.hand_scene or "paper").name
        orientation = new.orientation or parts.settings.teleoperation.orientation
        owners = parts.recorder.owners
        for name in filter(None, (new.tracker, new.clutch)):
            owners.require_named(name)
        order = TeleopRequest(
            new.tracker,
            calibration,
            scene,
            new.scale,
            new.share,
            new.clutch,
            orientation,
            owners.owner(new.tracker),
            owners.owner(new.clutch),
        )
        row = executions.teleoperate(order, lease=lease, who=who)
        response.headers["Location"] = f"/api/v1/executions/{row.id}"
        return row


def _add_looks(router: APIRouter, parts: Parts) -> None:
    executions = parts.executions
    readers = CapacityLimiter(MAX_READERS)

    @router.get("/executions", response_model=model_of(list[Execution]), dependencies=VIEW)
    def list_executions(page: WantedPage) -> Response:
        """List the executions, newest first."""
        return page.answer(executions.page(page.wanted))

    @router.get("/executions/{execution}", dependencies=VIEW)
    def get_execution(execution: str) -> Execution:
        """Return one execution with its newest status."""
        return executions.get(execution)

    @router.get(
        "/executions/{execution}/recording", response_class=FileResponse, responses=files(MCAP), dependencies=VIEW
    )
    def download_execution(execution: str) -> FileResponse:
        """Return all that was sent and done as an MCAP file: setpoints, states, statuses, journal; plan and path in it.

        `teachpath run --check FILE` judges it. While the execution runs, the file has no end yet.
        """
        file = executions.recording(execution)
        return FileResponse(file, media_type=MCAP, filename=f"{execution}.mcap")

    @router.get("/executions/{execution}/series", response_model=model_of(TimeSeries), dependencies=VIEW)
    async def get_series(
        execution: str, points: Annotated[int, Query(ge=2, le=20_000, description="at most")] = 500
    ) -> Response:
        """Return what the arm did over time, for plots and for a replay.

        Joints, velocities, torques, tool and object, tracking error, and the lateness of setpoints; no peak is lost.
        """

        def encoded() -> bytes:
            return parts.reader.call(encode_series, executions.recording(execution), points, parts.settings.arm)

        return Response(await run_sync(encoded, limiter=readers), media_type="application/json")


def _add_steering(router: APIRouter, executions: Executions) -> None:
    @router.post("/executions/{execution}/override", responses=refusals(409), dependencies=OPERATE)
    def set_override(execution: str, wanted: Override, who: Who, lease: Token = "") -> Execution:
        """Change the speed while the arm moves; 0 is a hold on the path."""
        return executions.command(
            execution, Command(CommandVerb.OVERRIDE, execution, override=wanted.override, lease=lease, who=who)
        )

    @router.post("/executions/{execution}/step", responses=refusals(409), dependencies=OPERATE)
    def step_execution(execution: str, wanted: Step, who: Who, lease: Token = "") -> Execution:
        """Move the held arm by a length or a number of nodes along the path, and hold it there."""
        if (wanted.length is None) == (wanted.nodes is None):
            raise UnusableInput("a step has a length in metres or a number of nodes: one of the two")
        command = Command(
            CommandVerb.STEP, execution, length=wanted.length or 0.0, nodes=wanted.nodes or 0, lease=lease, who=who
        )
        return executions.command(execution, command)

    @router.post("/executions/{execution}/{verb}", responses=refusals(409), dependencies=OPERATE)
    def steer_execution(
        execution: str, verb: Literal["hold", "resume", "reverse"], who: Who, lease: Token = ""
    ) -> Execution:
        """Hold on the path, resume, or go back along it.

        Resume brings an arm that was pushed away while it was held back to the path first.
        """
        return executions.command(execution, Command(CommandVerb(verb), execution, lease=lease, who=who))

    @router.post("/robot/acknowledge", responses=refusals(409), dependencies=OPERATE)
    def acknowledge_motion(who: Who, lease: Token = "") -> ExecutorStatus:
        """Say that you have seen why the arm moved although nothing was under way (`unasked_motion` of its status).

        Nothing starts before; it is refused while the arm does not rest.
        """
        return executions.acknowledge(lease=lease, who=who)


def stops_router(parts: Parts) -> APIRouter:
    """Return the routes that stop the arm: they are answered whatever else the request holds."""
    router, executions = APIRouter(tags=["executions"]), parts.executions
    threads = CapacityLimiter(MAX_STOPS)  # of stops alone, so that a stop waits for no other request

    @router.post("/executions/{execution}/stop", dependencies=NO_CAPABILITY)
    async def stop_execution(execution: str, sender: Sender, lease: AnyToken = "", label: AnyLabel = "") -> Execution:
        """Stop and end an execution; everybody may do it, and more than once.

        It is answered when the executor's own status shows that the execution ends or has ended; an answer of 503
        (NotStopped) says that the executor has not confirmed it, while the stop is repeated. A stop brings the arm to
        rest on its path: it is not an emergency stop. It is never refused for a field or parameter that it does not
        know.
        """
        who = signed(sender, label)
        return await run_sync(partial(executions.stop_one, execution, lease=lease, who=who), limiter=threads)

    @router.post("/stop", dependencies=NO_CAPABILITY)
    async def stop_arm(sender: Sender, lease: AnyToken = "", label: AnyLabel = "") -> ExecutorStatus:
        """Stop whatever moves the arm, on its path, as the stop of an execution does; everybody may do it."""
        who = signed(sender, label)
        return await run_sync(partial(executions.stop_all, lease=lease, who=who), limiter=threads)

    return router
