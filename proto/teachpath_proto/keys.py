"""The names on the wire: every Zenoh key of a station, built from one prefix."""

import re

NAME = re.compile(r"(?!.*\.\.)[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def is_name(text: str) -> bool:
    """Tell whether `text` may name a task, tracker, calibration, scene or robot.

    A name becomes a key segment, a folder and a piece of a URL; `name_refusal` tells the rule.
    """
    return NAME.fullmatch(text) is not None


def name_refusal(what: str, text: str) -> str:
    """Return the sentence that refuses `text` as the name of a `what`, e.g. "task"; it tells the whole rule."""
    return (
        f"{text[:80]!r} cannot name a {what}: use 1 to 64 of the letters a to z and A to Z, digits, '.', '_' and '-'; "
        "begin with a letter or digit, and never write '..'"
    )


def anonymous_refusal(tracker: str) -> str:
    """Return the sentence that refuses a tracker whose samples name no session on the bus to lead the arm."""
    return (
        f"samples as {tracker} name no session on the bus, so that anybody could send them, and no arm follows them: "
        "attach the session's id to each, or send with an advanced publisher (proto/README.md)"
    )


class Keys:
    """The keys of one station."""

    def __init__(self, prefix: str = "teachpath/station") -> None:
        self.prefix: str = prefix
        self.recorder_start: str = f"{prefix}/recorder/start"
        self.recorder_stop: str = f"{prefix}/recorder/stop"
        self.recorder_pause: str = f"{prefix}/recorder/pause"
        self.recorder_resume: str = f"{prefix}/recorder/resume"
        self.recorder_discard: str = f"{prefix}/recorder/discard"
        self.recorder_restore: str = f"{prefix}/recorder/restore"
        self.recorder_amend: str = f"{prefix}/recorder/amend"
        self.recorder_status: str = f"{prefix}/recorder/status"
        self.executor_command: str = f"{prefix}/executor/command"
        self.executor_stop: str = f"{prefix}/executor/stop"
        self.executor_lease: str = f"{prefix}/executor/lease"
        self.executor_journal: str = f"{prefix}/executor/journal"
        self.executor_status: str = f"{prefix}/executor/status"
        self.station_certificate: str = f"{prefix}/station/certificate"
        self.station_scene: str = f"{prefix}/station/scene"
        self.all_objects: str = f"{prefix}/scenes/*/object"
        self.all_samples: str = f"{prefix}/trackers/*/samples"
        self.all_alive: str = f"{prefix}/alive/**"
        self.all_trackers_alive: str = f"{prefix}/alive/tracker/*"

    def samples(self, tracker: str) -> str:
        """Key on which `tracker` publishes its `HandSample`s."""
        return f"{self.prefix}/trackers/{tracker}/samples"

    def feedback(self, tracker: str) -> str:
        """Key on which the recorder tells `tracker` its `HandFeedback`."""
        return f"{self.prefix}/trackers/{tracker}/feedback"

    def tracker_of(self, key: str) -> str:
        """Name of the tracker that published on `key` (a key of `samples`)."""
        return key.removeprefix(f"{self.prefix}/trackers/").split("/", 1)[0]

    def object(self, scene: str) -> str:
        """Key on which a camera publishes where the object of `scene` lies: an `ObjectPose` as JSON."""
        return f"{self.prefix}/scenes/{scene}/object"

    def scene_of(self, key: str) -> str:
        """Name of the scene whose object was told on `key` (a key of `object`)."""
        return key.removeprefix(f"{self.prefix}/scenes/").split("/", 1)[0]

    def announced(self, key: str) -> str:
        """Name of the part that shows on `key` (a key of `alive`) that it is alive."""
        return key.rsplit("/", 1)[1]

    def setpoint(self, robot: str) -> str:
        """Key of the `Setpoint` stream to `robot`."""
        return f"{self.prefix}/robot/{robot}/setpoint"

    def state(self, robot: str) -> str:
        """Key of the `JointState` stream from `robot`."""
        return f"{self.prefix}/robot/{robot}/state"

    def reset(self, robot: str) -> str:
        """Key of the query that puts the simulated `robot` back to its home."""
        return f"{self.prefix}/robot/{robot}/reset"

    def job(self, job: str) -> str:
        """Key of the `JobProgress` of one job."""
        return f"{self.prefix}/jobs/{job}"

    def alive(self, kind: str, name: str) -> str:
        """Liveliness token of a running part, e.g. `alive("tracker", "glove-1")`."""
        return f"{self.prefix}/alive/{kind}/{name}"
