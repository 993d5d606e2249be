"""Guidance while demonstrating: after every new demonstration, how far those of the task agree and what is missing."""

from __future__ import annotations

import queue
from collections.abc import Callable

import numpy as np

from teachpath.errors import TeachpathError
from teachpath.io.store.recordings import Recordings
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.periodic_thread import PeriodicThread
from teachpath.recorder.recording_work import Call, call_directly, read_trajectory
from teachpath.recording.guidance import ClusterSummary, advise
from teachpath.records import Array, Demonstration, Trajectory, Vector

MAX_DEMONSTRATIONS = 60  # newest ones that are compared
RESAMPLED_POINTS = 50  # of each demonstration, at equal arc length
POLL_INTERVAL = 0.05  # [s] between two looks for requests


class GuidanceThread:
    """Keeps one sentence of advice a task, compared anew on request on a thread of its own.

    Args:
        demonstrations: returns the demonstrations of a task.
        course: returns the course (RESAMPLED_POINTS, 3) [m] of the object in a demonstration; see `read_course`.
        settings: of learning, whose clustering is used.
        call: calls what compares the courses.
    """

    def __init__(
        self,
        demonstrations: Callable[[str], list[Demonstration]],
        course: Callable[[Demonstration], Array],
        settings: LearningSettings,
        call: Call = call_directly,
    ) -> None:
        self._demonstrations = demonstrations
        self._read_course = course
        self._settings = settings
        self._call = call
        self._requests: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._courses: dict[tuple[str, tuple[int, int]], Array] = {}  # by id and transport phase
        self._advice: dict[str, str] = {}
        self._thread = PeriodicThread("guidance", POLL_INTERVAL, self._serve_requests)

    def start(self) -> None:
        """Serve requests from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Finish the comparison that is under way, and stop; a second call does nothing."""
        self._thread.stop()

    def request(self, task: str) -> None:
        """Have the demonstrations of a task compared anew, soon."""
        self._requests.put(task)

    def advice(self, task: str) -> str:
        """Return the newest advice for a task, or nothing."""
        return self._advice.get(task, "")

    def all_advice(self) -> dict[str, str]:
        """Return the newest advice by task."""
        return dict(self._advice)

    def compare(self, task: str) -> str:
        """Compare the demonstrations of a task now and return the advice."""
        usable = [d for d in self._demonstrations(task) if d.is_usable][-MAX_DEMONSTRATIONS:]
        courses = [self._course(d) for d in usable]
        self._courses = {(d.id, d.transport): c for d, c in zip(usable, courses, strict=True)}
        if not courses:
            return ""
        sentence: str = self._call(advise_on, np.array(courses), self._settings)
        return sentence

    def _serve_requests(self) -> None:
        """Compare every task that was requested since the last call, once."""
        tasks: dict[str, None] = {}
        while not self._requests.empty():
            tasks[self._requests.get()] = None
        for task in tasks:
            try:
                self._advice[task] = self.compare(task)
            except TeachpathError as error:
                self._advice[task] = f"the demonstrations cannot be compared: {error}"

    def _course(self, demonstration: Demonstration) -> Array:
        known = self._courses.get((demonstration.id, demonstration.transport))
        return self._read_course(demonstration) if known is None else known


def course_of(trajectory: Trajectory) -> Array:
    """Return the course (RESAMPLED_POINTS, 3) [m] of a trajectory."""
    return at_equal_arc_length(smoothed(trajectory), RESAMPLED_POINTS)


def read_course(recordings: Recordings, demonstration: Demonstration, carried: Vector | None) -> Array:
    """Return the course of the object in a demonstration; as `read_trajectory`."""
    return course_of(read_trajectory(recordings, demonstration, carried))


def advise_on(courses: Array, settings: LearningSettings) -> str:
    """Return the advice for demonstrations of these courses (n, RESAMPLED_POINTS, 3) [m]."""
    length = float(np.median([arc_lengths(course)[-1] for course in courses]))
    return advise(_clusters(courses, settings, length), length)


def _clusters(courses: Array, settings: LearningSettings, length: float) -> list[ClusterSummary]:
    """Group courses (n, RESAMPLED_POINTS, 3) [m] of paths of a typical `length` [m]."""
    if len(courses) < 2:
        return [ClusterSummary(len(courses), 0.0)]
    condensed = pairwise_distances(courses)
    labels = cluster_paths(courses, settings, length=length, metric="arc").labels
    left, right = np.triu_indices(len(courses), 1)
    summaries = []
    for label in range(1, int(labels.max()) + 1):
        within = condensed[(labels[left] == label) & (labels[right] == label)]
        summaries.append(ClusterSummary(int(np.count_nonzero(labels == label)), float(within.max(initial=0.0))))
    return summaries
