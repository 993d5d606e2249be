"""Requests of a station about itself, tasks, demonstrations and recordings: each method is one of the REST API."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

from teachpath_client.models import (
    ArmSummary,
    Demonstration,
    FileReport,
    Health,
    Identity,
    Job,
    MeasuredCalibration,
    MeshHull,
    ObjectPose,
    RecordingReport,
    Robot,
    SavedScene,
    Scene,
    SceneVersion,
    StoredArm,
    Task,
    Touch,
    Trajectory,
    Upload,
)
from teachpath_client.rest import Rest

Point = tuple[float, float, float]


class TaskResources(Rest):
    """The station, its tasks and what was shown; every method raises Unreachable or Refused."""

    # the station

    def health(self) -> Health:
        """Return which parts run, and what an operator should know."""
        return self._ask(Health, "GET", "/health")

    def identity(self) -> Identity:
        """Return who this program is for the station, and what it may do."""
        return self._ask(Identity, "GET", "/identity")

    def scenes(self) -> list[Scene]:
        """List the scenes, each with its object where it lies now."""
        return self._ask(list[Scene], "GET", "/scenes")

    def get_scene(self, name: str, number: int | None = None) -> SavedScene:
        """Return a scene as it was saved: its newest version, or one of them."""
        return self._ask(SavedScene, "GET", f"/scenes/{name}" + ("" if number is None else f"/versions/{number}"))

    def scene_versions(self, name: str) -> list[SceneVersion]:
        """List the versions of a scene, newest first, of one that was removed too."""
        return self._ask(list[SceneVersion], "GET", f"/scenes/{name}/versions")

    def save_scene(self, name: str, scene: Mapping[str, Any], **options: Any) -> SceneVersion:
        """Make a scene, or save a changed one as its newest version.

        Args:
            name: of the scene.
            scene: obstacles, carried, floor, keep_in, keep_out, display_name, as `PUT /scenes/{scene}` takes them.
            options: base, author, note.
        """
        return self._ask(SceneVersion, "PUT", f"/scenes/{name}", dict(scene) | options)

    def copy_scene(self, name: str, copy: str, *, display_name: str = "") -> SceneVersion:
        """Keep a scene under another name too, and say what people call the copy (empty: by that name)."""
        body = {"name": copy, "display_name": display_name}
        return self._ask(SceneVersion, "POST", f"/scenes/{name}/copies", body)

    def remove_scene(self, name: str) -> SceneVersion:
        """Remove a scene that no task is done in; its versions stay."""
        return self._ask(SceneVersion, "DELETE", f"/scenes/{name}")

    def read_mesh(self, content: bytes, name: str, max_pieces: int = 1) -> MeshHull:
        """Return the convex hull of a mesh file (OBJ, STL, PLY, GLB), or its pieces, as a shape of a scene takes them.

        Args:
            content: of the file.
            name: of the file; its end says what it is.
            max_pieces: most convex pieces that it is cut into; 1: its hull.
        """
        return self._ask(MeshHull, "POST", "/meshes", content=content, name=name, max_pieces=max_pieces)

    def get_object(self, scene: str) -> ObjectPose:
        """Return where the object of a scene lies."""
        return self._ask(ObjectPose, "GET", f"/scenes/{scene}/object")

    def tell_object(self, scene: str, position: Sequence[float], **orientation: Sequence[float]) -> ObjectPose:
        """Say where the object of a scene lies [m, world]; orientation: w, x, y, z."""
        return self._ask(ObjectPose, "PUT", f"/scenes/{scene}/object", {"position": list(position)} | orientation)

    def reset_object(self, scene: str) -> ObjectPose:
        """Put the object of a scene back to where the scene has it."""
        return self._ask(ObjectPose, "DELETE", f"/scenes/{scene}/object")

    def robot(self) -> Robot:
        """Return how the arm is built."""
        return self._ask(Robot, "GET", "/robot")

    def arms(self) -> list[Robot]:
        """List the published arms that the station's settings may name; `robot` is the one that they name."""
        return self._ask(list[Robot], "GET", "/arms")

    def stored_arms(self) -> list[ArmSummary]:
        """List the arms that were added from models in URDF or MJCF."""
        return self._ask(list[ArmSummary], "GET", "/arms/stored")

    def stored_arm(self, name: str) -> StoredArm:
        """Return the newest version of an arm that was added."""
        return self._ask(StoredArm, "GET", f"/arms/stored/{name}")

    def measure_calibration(
        self,
        name: str,
        points: Iterable[tuple[Point, Point]],
        *,
        source: str = "",
        fit_scale: bool = False,
        keep: bool = True,
        author: str = "",
    ) -> MeasuredCalibration:
        """Fit a calibration to points, each as the tracker saw it and where it is [m, world], and keep it."""
        taught = [{"tracker": tracker, "world": world} for tracker, world in points]
        body = {"points": taught, "source": source, "fit_scale": fit_scale, "keep": keep, "author": author}
        return self._ask(MeasuredCalibration, "PUT", f"/calibrations/{name}", body)

    def touch(self, tracker: str, *, hold_time: float = 1.0) -> Touch:
        """Return where a tracker sees itself [m, tracker], held still from now on for `hold_time` [s]."""
        return self._ask(Touch, "POST", f"/trackers/{tracker}/touches", {"hold_time": hold_time})

    # tasks and their demonstrations

    def tasks(self, *, archived: bool = False) -> list[Task]:
        """List the tasks, or those that were deleted, oldest first."""
        return self._list(Task, "/tasks", archived=archived) if archived else self._list(Task, "/tasks")

    def get_task(self, task: str) -> Task:
        """Return one task."""
        return self._ask(Task, "GET", f"/tasks/{task}")

    def make_task(
        self,
        task: str,
        *,
        scene: str = "",
        calibration: str = "",
        object_at_grasp: bool | None = None,
        display_name: str = "",
    ) -> Task:
        """Make a task. One that exists stays as it is; it is refused (409) where it is not as asked.

        Args:
            task: its name.
            scene: what stands around the arm; empty: paper.
            calibration: of the tracker's frame; empty: identity.
            object_at_grasp: whether the object lies where the hand grasps; None: it does not.
            display_name: what people call it, e.g. "Küche räumen"; `teachpath_proto.display_names.id_of` makes a name
                of that. Empty: its name.
        """
        wanted: dict[str, object] = {"scene": scene or None, "calibration": calibration or None}
        wanted |= {"object_at_grasp": object_at_grasp, "display_name": display_name or None}
        body = {name: value for name, value in wanted.items() if value is not None}
        return self._ask(Task, "PUT", f"/tasks/{task}", body)

    def delete_task(self, task: str) -> Task:
        """Archive a task: lists leave it out, and nothing is begun with it; `restore_task` brings it back."""
        return self._ask(Task, "DELETE", f"/tasks/{task}")

    def restore_task(self, task: str) -> Task:
        """Bring back a task that was deleted."""
        return self._ask(Task, "POST", f"/tasks/{task}/restore")

    def rename_task(self, task: str, name: str = "", *, display_name: str | None = None) -> Task:
        """Give a task another name, with all that is of it, or another display name; what is left out stays."""
        changes = {"name": name or task, "display_name": display_name}
        return self._ask(Task, "PATCH", f"/tasks/{task}", changes)

    def demonstrations(self, task: str) -> list[Demonstration]:
        """List a task's demonstrations in their order; `pages` gives a long list bit by bit."""
        return self._list(Demonstration, f"/tasks/{task}/demonstrations")

    def begin_import(self, task: str, content: bytes, **options: Any) -> Job:
        """Queue the import of a file; every motion in it becomes a demonstration, all of them or none.

        Args:
            task: whose demonstrations they become.
            content: of the file.
            options: name, format (csv, npy, robottasks or mcap), units, rate, scene, calibration, object_at_grasp.
        """
        return self._ask(Job, "POST", f"/tasks/{task}/demonstrations", content=content, **options)

    def upload(self, content: bytes, name: str) -> Upload:
        """Send a file that is to be examined and imported with others."""
        return self._ask(Upload, "POST", "/uploads", content=content, name=name)

    def examine(self, upload: str, task: str, **choices: Any) -> FileReport:
        """Say what is understood of an upload, and what would be made of it in a task.

        Args:
            choices: name, format, units, time, rate, columns, quaternion, track, grasp, release, whole.
        """
        return self._ask(FileReport, "POST", f"/uploads/{upload}/examination", {"task": task, "file": choices})

    def begin_imports(self, task: str, files: Iterable[dict[str, Any]], **options: Any) -> Job:
        """Queue the import of uploads, all of them or none; each of `files` has `upload` and choices as `examine`."""
        return self._ask(Job, "POST", f"/tasks/{task}/imports", {"files": list(files)} | options)

    def amend(
        self,
        demonstration: str,
        *,
        mark: Literal["", "good", "bad"] | None = None,
        discarded: bool | None = None,
        trim: tuple[int, int] | None = None,
    ) -> Demonstration:
        """Mark, discard, restore or trim a demonstration; what is None stays as it is."""
        given = {"mark": mark, "discarded": discarded, "trim": trim}
        body = {name: value for name, value in given.items() if value is not None}
        return self._ask(Demonstration, "PATCH", f"/demonstrations/{demonstration}", body)

    def recalibrate(self, task: str, calibration: str = "") -> list[Demonstration]:
        """Put a task's demonstrations under a calibration (empty: each one's own, as it is today)."""
        return self._ask(list[Demonstration], "POST", f"/tasks/{task}/calibration", {"calibration": calibration})

    def trajectory(self, demonstration: str, *, most: int = 100_000) -> Trajectory:
        """Return the object's trajectory of a demonstration, thinned to `most` points."""
        return self._ask(Trajectory, "GET", f"/demonstrations/{demonstration}/trajectory", most=most)

    def recorded_demonstration(self, demonstration: str) -> bytes:
        """Return the MCAP file of a demonstration, with every sample."""
        return self._download(f"/demonstrations/{demonstration}/recording")

    # recording

    def recordings(self, task: str) -> list[RecordingReport]:
        """List the reports of a task's running recordings."""
        return self._ask(list[RecordingReport], "GET", f"/tasks/{task}/recording")

    def start_recording(self, task: str, tracker: str, **options: Any) -> RecordingReport:
        """Start recording from a tracker; options: calibration, rate, armed, countdown, takes, one_by_one."""
        return self._ask(RecordingReport, "POST", f"/tasks/{task}/recording", {"tracker": tracker} | options)

    def stop_recording(self, task: str, tracker: str, *, discard: bool = False) -> RecordingReport:
        """Stop recording, and return the account of every sample."""
        body = {"tracker": tracker, "discard": discard}
        return self._ask(RecordingReport, "POST", f"/tasks/{task}/recording/stop", body)
