"""Scenes: what stands around the arm. They are made, changed, copied and removed; every version is kept."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Response
from pydantic import Field, Strict

from teachpath.api.access import TEACH, VIEW, Sender, signed
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.names import DisplayName
from teachpath.api.parts import Parts
from teachpath.api.poses import Coordinate, Position, Quaternion
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.api.versions import LINE_PATTERN
from teachpath.editing import MAX_COORDINATE
from teachpath.errors import UnusableInput
from teachpath.io.meshes import MAX_PIECES
from teachpath.motion.collision.scene_checks import MAX_MASS, MIN_MASS
from teachpath.records import SavedScene, Scene, SceneVersion, Shape
from teachpath.records.poses import unit_quaternion
from teachpath_proto.keys import is_name, name_refusal

MAX_SHAPES = 200
MAX_VERTICES = 60_000  # of one mesh
Length = Annotated[float, Field(gt=0, le=MAX_COORDINATE, allow_inf_nan=False)]
Offset = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]  # in the units of a mesh
Point = Annotated[tuple[Offset, Offset, Offset], Strict(False)]


class ShapeBody(Body):
    """One body of a scene, or a zone."""

    name: str = Field(description="of the shape within its scene")
    kind: Literal["box", "cylinder", "sphere", "mesh"] = Field(description="what `size` and `vertices` mean")
    size: list[Length] = Field(
        max_length=3,
        description="[m] of a box its edges x, y, z; of a cylinder radius and height, along its z; of a sphere its "
        "radius; of a mesh the factor from its units to metres",
    )
    position: Position = Field(description="x, y, z of its centre, of a mesh its origin [m, world]")
    color: int = Field(0x8090A0, ge=0, le=0xFFFFFF, description="RGB in 24 bits, 0xRRGGBB")
    orientation: Quaternion = Field((1.0, 0.0, 0.0, 0.0), description="to world from shape, quaternion w, x, y, z")
    file: str = Field("", max_length=255, description="from which a mesh was read; only a name")
    vertices: list[Point] = Field(
        [],
        max_length=MAX_VERTICES,
        description="of a mesh, in its own units; their convex hull, or that of each piece, takes its place",
    )
    max_pieces: int = Field(
        1, ge=1, le=MAX_PIECES, description="most convex pieces that the mesh was cut into when its file was read"
    )
    pieces: list[Annotated[int, Field(ge=4)]] = Field(
        [],
        max_length=MAX_PIECES,
        description="of an obstacle's or zone's mesh: number of triangles of each convex piece, in the order of "
        "`vertices`, three a triangle; none: it is one hull",
    )
    mass: float | None = Field(
        None,
        ge=MIN_MASS,
        le=MAX_MASS,
        description="of the carried object [kg]; null: that of its volume at 300 kg/m^3; others have none",
    )

    def shape(self, place: str) -> Shape:
        """Return the shape; raises UnusableInput."""
        orientation = unit_quaternion(self.orientation, f"{place}.orientation")
        given = self.model_dump(exclude={"orientation", "size", "vertices", "pieces"})
        return Shape(
            **given,
            size=tuple(self.size),
            orientation=orientation,
            vertices=tuple(self.vertices),
            pieces=tuple(self.pieces),
        )


class SceneBody(Body):
    """What stands around the arm, as it is from now on."""

    obstacles: list[ShapeBody] = Field([], max_length=MAX_SHAPES, description="what stands there, the table among it")
    carried: ShapeBody | None = Field(None, description="the object where it lies; null: the scene has none")
    floor: Coordinate = Field(0.0, description="height of the floor [m, world]; the arm's foot stands at 0")
    keep_in: list[ShapeBody] = Field(
        [], max_length=MAX_SHAPES, description="boxes that arm, gripper and carried object stay inside"
    )
    keep_out: list[ShapeBody] = Field([], max_length=MAX_SHAPES, description="shapes of any kind that they stay out of")
    display_name: DisplayName = Field("", description="what people call it; empty: its name; plans hold all the same")
    base: int | None = Field(
        None, ge=0, description="number of the version that was changed, 0 for a new scene; null: whichever is newest"
    )
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who changed it")
    note: str = Field("", max_length=2000, description="why")

    def scene(self, name: str) -> Scene:
        """Return the scene under a name; raises UnusableInput."""
        return Scene(
            name,
            tuple(shape.shape(f"obstacles.{k}") for k, shape in enumerate(self.obstacles)),
            self.carried.shape("carried") if self.carried else None,
            self.floor,
            tuple(shape.shape(f"keep_in.{k}") for k, shape in enumerate(self.keep_in)),
            tuple(shape.shape(f"keep_out.{k}") for k, shape in enumerate(self.keep_out)),
            self.display_name,
        )


class SceneCopy(Body):
    """The copy of a scene."""

    name: str = Field(description="of the copy; no scene may have it, or have had it")
    display_name: DisplayName = Field("", description="what people call the copy; empty: its name")
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who copies it")


def scenes_router(parts: Parts) -> APIRouter:
    """Return the routes of scenes."""
    router = APIRouter(tags=["station"])
    _add_readers(router, parts)
    _add_changes(router, parts)
    return router


def _add_readers(router: APIRouter, parts: Parts) -> None:
    scenes = parts.scenes

    @router.get("/scenes", dependencies=VIEW)
    def list_scenes() -> list[Scene]:
        """List the scenes: table, obstacles and the object where it lies."""
        return [parts.objects.scene(scene.name) for scene in scenes.all()]

    @router.get("/scenes/{scene}", response_model=model_of(SavedScene), dependencies=VIEW)
    def get_scene(scene: str) -> Response:
        """Return the newest version of a scene as it was saved; `/scenes/{scene}/object` says where its object lies."""
        return json_response(scenes.newest(scene))

    @router.get("/scenes/{scene}/versions", dependencies=VIEW)
    def list_scene_versions(scene: str) -> list[SceneVersion]:
        """List the versions of a scene, newest first, of a removed one too; one of the settings is the first."""
        return scenes.versions(scene)

    @router.get("/scenes/{scene}/versions/{number}", response_model=model_of(SavedScene), dependencies=VIEW)
    def get_scene_version(scene: str, number: int) -> Response:
        """Return one version of a scene."""
        return json_response(scenes.version(scene, number))


def _add_changes(router: APIRouter, parts: Parts) -> None:
    scenes = parts.scenes

    @router.put("/scenes/{scene}", responses=refusals(409, 507), dependencies=TEACH)
    def save_scene(scene: str, new: SceneBody, sender: Sender) -> SceneVersion:
        """Make a scene, or save a changed one as its newest version; an unchanged one stays as it is.

        Plans that were certified in a former version do not start. Demonstrations keep the place at which the object
        lay. Where it was told to lie is forgotten when the scene has it elsewhere than before. A scene does not change
        while the arm is under way, and its object lies where it is while somebody demonstrates with it.
        """
        from teachpath.robot.scene_preparation import (
            prepared_scene,  # with the libraries of planning, which nothing else here needs
        )

        given = parts.reader.call(prepared_scene, new.scene(scene), parts.settings.arm)
        before = next((each for each in scenes.all() if each.name == scene), None)
        moved = before is not None and before.carried != given.carried
        author = signed(sender, new.author)
        saved = scenes.save(given, base=new.base, author=author, note=new.note, use=_use(parts, scene, moved))
        if moved and given.carried:
            parts.objects.forget(scene)
        return saved

    @router.post(
        "/scenes/{scene}/copies",
        status_code=201,
        responses=refusals(409, 507) | located(201, "the copy"),
        dependencies=TEACH,
    )
    def copy_scene(scene: str, copy: SceneCopy, sender: Sender, response: Response) -> SceneVersion:
        """Keep a scene under another name too."""
        if not is_name(copy.name):
            raise UnusableInput(name_refusal("scene", copy.name))
        made = scenes.copy(scene, copy.name, display_name=copy.display_name, author=signed(sender, copy.author))
        response.headers["Location"] = f"/api/v1/scenes/{copy.name}"
        return made

    @router.delete("/scenes/{scene}", responses=refusals(409), dependencies=TEACH)
    def remove_scene(scene: str, sender: Sender) -> SceneVersion:
        """Remove a scene that no task is done in. Its versions stay, and saving one of them brings it back."""
        return scenes.remove(scene, author=sender.name, use=_use(parts, scene, True))


def _use(parts: Parts, scene: str, moved: bool) -> str:
    """Return what a change of a scene would disturb, in words; empty: nothing. `moved`: its object is another."""
    if parts.executions.is_moving():
        return "the arm is under way; stop it first"
    recorded = {status.task for status in parts.recorder.statuses()} if moved else set()
    tasks = sorted(task for task in recorded if parts.store.task(task).scene == scene)
    return f"task {tasks[0]} is recorded with its object; end the recording first" if tasks else ""
