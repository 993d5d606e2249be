"""Where the objects of the scenes lie: told by whoever sees them."""

from __future__ import annotations

from fastapi import APIRouter
from pydantic import Field

from teachpath.api.access import TEACH, VIEW
from teachpath.api.parts import Parts
from teachpath.api.poses import Position, Quaternion
from teachpath.api.strict_requests import Body
from teachpath.records import ObjectPose


class SeenObject(Body):
    """Where the object of a scene was seen."""

    position: Position = Field(description="x, y, z of its centre [m, world]")
    orientation: Quaternion = Field((1.0, 0.0, 0.0, 0.0), description="quaternion w, x, y, z in the world")


def objects_router(parts: Parts) -> APIRouter:
    """Return the routes of the objects' poses."""
    router = APIRouter(tags=["station"])
    poses = parts.objects

    @router.get("/scenes/{scene}/object", dependencies=VIEW)
    def get_object(scene: str) -> ObjectPose:
        """Return where the object of a scene lies."""
        return poses.pose(scene)

    @router.put("/scenes/{scene}/object", dependencies=TEACH)
    def put_object(scene: str, seen: SeenObject) -> ObjectPose:
        """Say where the object of a scene lies, and return where it lies now.

        Plans that take it elsewhere do not start. While the arm moves, the scene stays as it was until it rests; a
        difference of less than 1 mm and 1 degree is none. A camera may publish the same on the bus, as JSON. A restart
        of the station forgets it.
        """
        return poses.tell(scene, ObjectPose(seen.position, seen.orientation))

    @router.delete("/scenes/{scene}/object", dependencies=TEACH)
    def reset_object(scene: str) -> ObjectPose:
        """Put the object of a scene back to where the scene has it, and return where that is."""
        return poses.forget(scene)

    return router
