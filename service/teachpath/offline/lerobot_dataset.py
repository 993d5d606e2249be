"""The demonstrations of a task as a LeRobot dataset: a frame a sample, the hand in the world and as it was measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.io.lerobot import Dataset, Feature, write_dataset
from teachpath.io.lerobot_v21 import write_dataset_v21
from teachpath.io.store.store import Store
from teachpath.recording.demonstration import carried_numbers, to_world
from teachpath.recording.phases import TransportSpan
from teachpath.records import Array, Demonstration, Sample
from teachpath_proto.sample_rules import GRASP_BUTTON

RATE = 50  # [Hz] said of demonstrations whose own rate is not known


WRITERS: Final = {"lerobot": write_dataset, "lerobot-2.1": write_dataset_v21}  # by the name of the format


def write_lerobot(
    store: Store,
    demonstrations: Sequence[Demonstration],
    kind: str,
    root: Path,
    progress: Callable[[float, str], None],
) -> None:
    """Write demonstrations of one task as a dataset of a kind (a key of `WRITERS`) into the new folder `root`.

    A frame is a sample, in the order of their numbers, each once; untracked ones are flagged, and none is made up.
    """
    takes = []
    for done, d in enumerate(demonstrations):
        progress(done / len(demonstrations) / 2, f"reading demonstration {d.number}")
        takes.append(store.recordings.samples(d.recording, d.digest))
    root.mkdir()
    WRITERS[kind](root, dataset_of(demonstrations, takes), lambda f: progress(0.5 + f / 2, "writing the dataset"))
    progress(1.0, "done")


def _in_order(samples: Sequence[Sample]) -> list[Sample]:
    """Return samples in the order of their numbers, each once."""
    by_number: dict[int, Sample] = {}
    for sample in samples:
        by_number.setdefault(sample.sequence, sample)
    return [by_number[number] for number in sorted(by_number)]


def dataset_of(demonstrations: Sequence[Demonstration], received: Sequence[Sequence[Sample]]) -> Dataset:
    """Return the dataset of demonstrations and their samples, in the order received."""
    takes = [_in_order(samples) for samples in received]
    rates = [d.statistics.seen_rate for d in demonstrations if d.statistics.seen_rate > 0]
    turned = all(s.orientation for take in takes for s in take)
    names = ("x", "y", "z", *(("qw", "qx", "qy", "qz") if turned else ()), "closure")
    states = [_states(d, take, turned=turned) for d, take in zip(demonstrations, takes, strict=True)]
    actions = [np.vstack([state[1:], state[-1:]]) for state in states]  # where the hand is at the next sample
    features = {
        "observation.state": Feature("float32", names, states),
        "action": Feature("float32", names, actions),
        **_as_measured(takes, turned=turned),
        "transport": Feature("bool", (), [*map(_transport, demonstrations, received, takes)]),
    }
    said: dict[str, list[str]] = {
        "demonstration": [d.id for d in demonstrations],
        "source": [d.source for d in demonstrations],
        "calibration": [d.calibration.name for d in demonstrations],
        "verdict": [d.verdict.value for d in demonstrations],
        "reasons": ["; ".join(d.reasons) for d in demonstrations],
        "mark": [d.mark for d in demonstrations],
    }
    fps = max(round(float(np.median(rates))), 1) if rates else RATE
    times = [np.array([s.device_ns - take[0].device_ns for s in take]) * 1e-9 for take in takes]
    return Dataset(demonstrations[0].task, fps, times, features, said)


def _as_measured(takes: list[list[Sample]], *, turned: bool) -> dict[str, Feature]:
    """Return the samples as the tracker gave them, in its own frame and with its own clock."""

    def one(name: str, dtype: str) -> Feature:
        return Feature(dtype, (), [np.array([[getattr(s, name)] for s in take]) for take in takes])

    def several(name: str, dtype: str, names: Sequence[str]) -> Feature:
        return Feature(dtype, tuple(names), [np.array([getattr(s, name) for s in take]) for take in takes])

    found = {name: one(name, "int64") for name in ("sequence", "device_ns", "receive_ns", "buttons")}
    found |= {"tracked": one("tracked", "bool"), "tracker.position": several("position", "float64", "xyz")}
    if turned:
        found["tracker.orientation"] = several("orientation", "float64", ("qw", "qx", "qy", "qz"))
    sensors = {len(s.flexions) for take in takes for s in take}
    if len(sensors) == 1 and 0 not in sensors:
        found["observation.flexions"] = several("flexions", "float32", [f"f{i + 1}" for i in range(*sensors)])
    joints = {len(s.joints) for take in takes for s in take}  # of an arm that showed the task
    if len(joints) == 1 and 0 not in joints:
        found["observation.joints"] = several("joints", "float64", [f"j{i + 1}" for i in range(*joints)])
    return found


def _states(demonstration: Demonstration, take: list[Sample], *, turned: bool) -> Array:
    calibration = demonstration.calibration
    columns: list[Any] = [to_world(calibration, np.array([s.position for s in take]))]
    if turned:
        world = Rotation.from_quat(calibration.rotation, scalar_first=True)
        hand = Rotation.from_quat(np.array([s.orientation for s in take]), scalar_first=True)
        columns.append((world * hand).as_quat(scalar_first=True))
    closures = [sum(s.flexions) / len(s.flexions) if s.flexions else s.buttons & GRASP_BUTTON for s in take]
    return np.hstack([*columns, np.array(closures, dtype=np.float64)[:, None]])


def _transport(demonstration: Demonstration, received: Sequence[Sample], take: list[Sample]) -> Any:
    grasp, after = carried_numbers(received, TransportSpan(*demonstration.transport))
    return np.array([[grasp <= sample.sequence < after] for sample in take])
