"""The house: imports go down only, and one outside thing has one door (ARCHITECTURE.md, "Floors" and "Doors")."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SERVICE = ROOT / "service" / "teachpath"

# A room may import rooms of lower floors, and itself. Rooms of one floor are strangers.
FLOORS = [
    ["compiled", "errors", "lengths", "logs", "periodic_thread", "process_server", "realtime", "time_source"],
    ["nurbs"],
    ["exchange", "records"],
    ["editing", "trajectories"],
    ["learning", "motion", "recording", "io"],
    ["access", "recorder", "jobs", "executor", "simulator", "robot", "live", "web"],
    ["offline", "config", "python_api"],
    ["api", "instructions", "job_kinds", "stored_arm"],
    ["app", "job_service"],
    ["commands"],
    ["__main__"],
]
FLOOR = {room: level for level, rooms in enumerate(FLOORS) for room in rooms}

# The same within a room: its folders and files. A group of one floor knows no other of it.
GROUPS = {
    "learning": [
        ["settings", "resampling", "matching", "input_validation"],
        ["clustering", "selection", "fitting"],
        ["summary", "compare", "adaptation"],
        ["learn"],
        ["relearn", "evaluation"],
    ],
    "motion": [
        ["settings", "refusals"],
        ["arm"],
        ["collision", "paths", "analysis"],
        ["timing"],
        ["planning"],
        ["execution"],
    ],
}
SIDE_ROOMS = ("motion.analysis",)  # groups that judge what the others make, so that none of those may use them

GENERATED_MODULES = "teachpath_proto.*_pb2"  # the modules that protoc generates

DOORS = {
    GENERATED_MODULES: ["io/wire"],
    "zenoh": ["io/bus.py"],
    "json5": ["io/bus_config.py"],
    "distributed": ["jobs/cluster.py", "jobs/cluster_executor.py", "jobs/cluster_worker.py"],
    "argon2": ["access/passwords.py"],
    "cryptography": ["io/certificates.py", "io/web_certificates.py"],
    "joserfc": ["io/identity_provider.py"],
    "httpx": ["io/identity_provider.py"],
    "segno": ["api/authority.py"],
    "google": ["io/wire"],
    "cattrs": ["io/documents.py"],
    "sqlalchemy": ["io/store"],
    "alembic": ["io/store"],
    "coacd": ["io/mesh_pieces.py"],
    "trimesh": ["io/mesh_pieces.py"],
    "obstore": ["io/store/object_storage.py"],
    "mcap": ["io/store", "io/programs/rosbag.py"],
    "mcap_protobuf": ["io/store"],
    "foxglove_schemas_protobuf": ["io/store"],
    "jinja2": ["offline/report/package.py", "io/programs/robot_program.py"],
    "hmmlearn": ["learning/selection/hmm.py"],
    "geomdl": ["exchange.py"],
    "ruckig": ["motion/execution/tool_motion.py", "motion/timing/joint_moves.py", "motion/timing/ruckig_check.py"],
    "numba": ["compiled.py", "learning/clustering/kernels.py"],
    "mujoco": [
        "io/arm_models",
        "motion/collision/collision_model.py",
        "motion/collision/self_collision.py",
        "motion/arm/dynamics.py",
        "simulator/arm.py",
    ],
    "meshcat": ["live/preview"],
    "umsgpack": ["live/preview"],
    "fastapi": ["api", "app.py"],
    "starlette": ["api"],
    "uvicorn": ["web"],
    "typer": ["__main__.py", "commands"],
    "rich": ["commands"],
    "prometheus_client": ["api/metrics.py"],
    "pyarrow": ["io/lerobot.py", "io/lerobot_v21.py", "io/readers/lerobot.py"],
    "rosbags": ["io/readers/bags.py"],
    "h5py": ["io/readers/hdf5.py"],
    "c3d": ["io/readers/c3d.py"],
    "pydantic": ["config.py", "api"],
}


# The command line is a client of the REST API: the only rooms that know a client, and what they know of it.
REST_SPEAKERS = ("commands", "__main__")
CLIENT_OF_REST = ("teachpath_client.station", "teachpath_client.models", "teachpath_client.errors")


def imports(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def outside_thing(name: str) -> str:
    """Return which entry of DOORS an imported name belongs to."""
    package, *rest = name.split(".")
    return (
        GENERATED_MODULES if package == "teachpath_proto" and any(part.endswith("_pb2") for part in rest) else package
    )


def room(file: Path) -> str:
    return file.relative_to(SERVICE).parts[0].removesuffix(".py")


def group(file: Path) -> str:
    """Folder or file of a room."""
    return file.relative_to(SERVICE).parts[1].removesuffix(".py")


def modules() -> list[Path]:
    return [f for f in sorted(SERVICE.rglob("*.py")) if f != SERVICE / "__init__.py"]


@pytest.mark.parametrize("file", modules(), ids=lambda f: f.relative_to(SERVICE).as_posix())
def test_imports_go_down_only(file: Path) -> None:
    here = room(file)
    for name in imports(file):
        parts = name.split(".")
        if parts[0] != "teachpath" or len(parts) < 2 or parts[1] == "__version__":
            continue
        assert parts[1] == here or FLOOR[parts[1]] < FLOOR[here], f"{here} must not import {name}"


@pytest.mark.parametrize(
    "file",
    [f for f in modules() if room(f) in GROUPS and f.name != "__init__.py"],
    ids=lambda f: f.relative_to(SERVICE).as_posix(),
)
def test_imports_within_a_room_go_down_only(file: Path) -> None:
    of, here = room(file), group(file)
    floor = {name: level for level, names in enumerate(GROUPS[of]) for name in names}
    for name in imports(file):
        parts = name.split(".")
        if parts[:2] != ["teachpath", of] or len(parts) < 3 or parts[2] == here:
            continue
        assert floor[parts[2]] < floor[here], f"{of}.{here} must not import {name}"
        assert f"{of}.{parts[2]}" not in SIDE_ROOMS, f"{of}.{here} must not import {name}"


@pytest.mark.parametrize("of", GROUPS)
def test_every_group_of_a_room_has_a_floor(of: str) -> None:
    groups = {group(file) for file in modules() if room(file) == of and file.name != "__init__.py"}
    assert groups == {name for names in GROUPS[of] for name in names}


@pytest.mark.parametrize("file", modules(), ids=lambda f: f.relative_to(SERVICE).as_posix())
def test_every_outside_thing_has_one_door(file: Path) -> None:
    place = file.relative_to(SERVICE).as_posix()
    for name in imports(file):
        doors = DOORS.get(outside_thing(name))
        assert doors is None or any(place.startswith(door) for door in doors), f"{place} must not import {name}"


def test_no_door_is_unused() -> None:
    used = {outside_thing(name) for file in modules() for name in imports(file)}
    assert set(DOORS) <= used


# The simulated arm plays setpoints as every driver does: with the one player.
PLAYER = ("teachpath_client.driver",)


def test_service_and_clients_are_strangers() -> None:
    for file in modules():
        known = CLIENT_OF_REST if room(file) in REST_SPEAKERS else PLAYER if room(file) == "simulator" else ()
        used = {name for name in imports(file) if name.startswith("teachpath_client")}
        assert all(name.startswith(known) for name in used), file
    for file in (ROOT / "clients" / "teachpath_client").rglob("*.py"):
        assert not any(name.split(".")[0] == "teachpath" for name in imports(file)), file
    for file in (ROOT / "clients" / "examples").rglob("*.py"):
        assert not any(name.startswith("teachpath.") for name in imports(file)), f"{file}: import teachpath"
    for file in (ROOT / "proto").rglob("*.py"):
        assert not any(name.split(".")[0] in ("teachpath", "teachpath_client") for name in imports(file)), file


def test_ruckigs_network_service_is_never_asked() -> None:
    for file in modules():
        names = {node.attr for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Attribute)}
        assert "intermediate_positions" not in names, file


@pytest.mark.parametrize(
    ("module", "needless"),
    [
        ("teachpath", {"numpy", "teachpath.errors"}),
        (
            "teachpath.__main__",
            {
                "websockets",
                "scipy.linalg",
                "numba",
                "hmmlearn",
                "sqlalchemy",
                "fastapi",
                "mujoco",
                "meshcat",
                "cryptography",
                # of the standard library, which every `--help` would wait for
                "asyncio",
                "logging.handlers",
                "ssl",
                "tomllib",
            },
        ),
        ("teachpath.simulator.loop", {"scipy.linalg", "numba", "hmmlearn", "sqlalchemy", "fastapi"}),
        ("teachpath.executor.loop", {"hmmlearn", "sqlalchemy", "fastapi", "meshcat"}),
        ("teachpath.learning.relearn", {"numba", "sklearn", "scipy.stats", "scipy.signal", "matplotlib"}),
        (
            "teachpath.app",
            {
                "numba",
                "hmmlearn",
                "mujoco",
                "cryptography",
                "alembic",
                "jinja2",
                "geomdl",
                "segno",
                "scipy.interpolate",
            },
        ),
        ("teachpath.live.preview.commands", {"meshcat", "meshcat.visualizer", "IPython", "tornado", "zmq", "PIL"}),
    ],
)
def test_a_process_loads_only_what_it_uses(module: str, needless: set[str]) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert module in loaded
    assert not needless & set(loaded)
