"""Kubernetes and Compose take what deploy/ has for several cells, and the settings in it are a station's."""

import json
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import json5
import jsonschema
import pytest
import typer.main
import yaml

from teachpath.__main__ import app
from teachpath.access.loopback import require_safe_binding
from teachpath.config import Settings, load
from tests.contract.deploy_schemas import COMPOSE, KUBERNETES
from tests.contract.test_requirements import FILES, pins

DEPLOY = Path(__file__).parents[2] / "deploy"
CLUSTER = DEPLOY / "kubernetes"
KUSTOMIZATION = yaml.safe_load((CLUSTER / "kustomization.yaml").read_text())
RESOURCES = [
    document for name in KUSTOMIZATION["resources"] for document in yaml.safe_load_all((CLUSTER / name).read_text())
]
SITE = yaml.safe_load((DEPLOY / "compose-site.yaml").read_text())
PODS = {r["metadata"]["name"]: r["spec"]["template"]["spec"] for r in RESOURCES if "template" in r.get("spec", {})}
OWN_NAME = "tests' own"  # of values that come from a Secret

KINDS = json.loads(KUBERNETES.read_text())


def schema(name: str) -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator({"$ref": f"#/$defs/{name}", **KINDS})


def faults(resource: dict[str, Any]) -> list[str]:
    return [error.message for error in schema(resource["kind"]).iter_errors(resource)]


def named(resource: dict[str, Any]) -> str:
    return f"{resource['kind']} {resource['metadata']['name']}"


@contextmanager
def variables(given: dict[str, str]) -> Iterator[None]:
    """Set a pod's variables for a while, and none of teachpath's else."""
    before = dict(os.environ)
    for name in [name for name in os.environ if name.startswith("TEACHPATH_")]:
        del os.environ[name]
    os.environ.update({name: value for name, value in given.items() if name.startswith("TEACHPATH_")})
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def of_pod(container: dict[str, Any], name: str) -> Settings:
    """Return the settings of a pod with this name, as Kubernetes and the service make them."""
    given: dict[str, str] = {}
    for variable in container["env"]:
        source = variable.get("valueFrom", {})
        field = source.get("fieldRef", {}).get("fieldPath")
        value = {"metadata.name": name, None: OWN_NAME}.get(field, name.rpartition("-")[2])
        given[variable["name"]] = re.sub(r"\$\((\w+)\)", lambda at: given[at[1]], variable.get("value", value))
    with variables(given):
        return load(CLUSTER / "teachpath.toml")


@pytest.mark.parametrize("resource", RESOURCES, ids=named)
def test_kubernetes_takes_it(resource: dict[str, Any]) -> None:
    assert faults(resource) == []


def test_what_kubernetes_would_refuse_is_found() -> None:
    cell = next(each for each in RESOURCES if named(each) == "StatefulSet cell")
    typed = json.loads(json.dumps(cell).replace("readinessProbe", "readynessProbe"))
    assert "'readynessProbe' was unexpected" in str(faults(typed))
    assert faults(cell | {"spec": cell["spec"] | {"replicas": "three"}})


def test_everything_is_applied_and_what_is_named_is_there() -> None:
    made = {entry for each in KUSTOMIZATION["configMapGenerator"] for entry in each["files"]}
    assert {file.name for file in CLUSTER.iterdir()} == {"kustomization.yaml", *KUSTOMIZATION["resources"], *made}
    maps = {each["name"] for each in KUSTOMIZATION["configMapGenerator"]}
    volumes = [volume for pod in PODS.values() for volume in pod["volumes"]]
    assert {volume["configMap"]["name"] for volume in volumes if "configMap" in volume} == maps
    for pod in PODS.values():
        claims = ["data"]  # of the templates of claims
        known = {volume["name"] for volume in pod["volumes"]} | set(claims)
        for container in (*pod.get("initContainers", ()), *pod["containers"]):
            assert {mount["name"] for mount in container["volumeMounts"]} <= known


@pytest.mark.parametrize("name", PODS)
def test_a_pod_may_do_no_more_than_it_needs(name: str) -> None:
    pod = PODS[name]
    assert pod["automountServiceAccountToken"] is False
    assert pod["enableServiceLinks"] is False  # a service's address is no setting
    assert pod["securityContext"]["runAsNonRoot"] is True
    assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    for container in (*pod.get("initContainers", ()), *pod["containers"]):
        assert container["securityContext"]["capabilities"] == {"drop": ["ALL"]}
        assert container["securityContext"]["allowPrivilegeEscalation"] is False
        assert container["resources"]["limits"].keys() == {"memory"}  # a limited processor would stop the control loop


def test_what_answers_others_says_when_it_is_ready() -> None:
    assert [name for name, pod in PODS.items() if "readinessProbe" in pod["containers"][0]] == [
        "postgres",
        "objects",
        "cell",
        "router",
    ]


def test_each_cell_has_settings_of_its_own_and_each_worker_its_cell() -> None:
    (cell,), (worker,) = PODS["cell"]["containers"], PODS["worker"]["containers"]
    cells = [of_pod(cell, f"cell-{number}") for number in range(3)]
    for settings, number in zip(cells, range(3), strict=True):
        web = settings.web
        require_safe_binding(settings.auth.mode, web.host, web.hosts, web.proxies)
        assert f"cell-{number}.lab.example" in web.hosts
        assert (settings.bus.endpoint, settings.bus.prefix) == (f"tls/cell-{number}:7447", f"lab/cell-{number}")
    workers = [of_pod(worker, f"worker-{number}") for number in range(3)]
    assert [each.store.station for each in workers] == [each.store.station for each in cells]
    assert {(each.store.database, each.store.recordings) for each in (*cells, *workers)} == {
        ("postgresql+psycopg://teachpath@postgres/teachpath", "s3://recordings/lab")
    }


def test_each_cell_has_an_address_of_its_own_and_none_is_shared() -> None:
    services = [each for each in RESOURCES if each["kind"] == "Service" and each["spec"].get("type") == "LoadBalancer"]
    chosen = [each["spec"]["selector"] for each in services]
    assert chosen == [{"statefulset.kubernetes.io/pod-name": f"cell-{number}"} for number in range(3)]
    assert [each["metadata"]["name"] for each in services] == [f"cell-{number}" for number in range(3)]


def test_the_router_is_the_sample_with_other_names_and_of_the_service_s_version() -> None:
    sample, ours = (json5.loads(file.read_text()) for file in (DEPLOY / "zenohd-site.json5", CLUSTER / "zenohd.json5"))
    (*_, first), (*_, last) = sample["connect"]["endpoints"], ours["connect"]["endpoints"]
    assert first.replace("cell-2.example", "cell-2") == last
    for document in (sample, ours):
        document["listen"], document["connect"]["endpoints"] = {}, []
    assert ours == sample
    (zenoh,) = (version for name, version, _ in pins(FILES["service"]) if name == "eclipse-zenoh")
    assert PODS["router"]["containers"][0]["image"] == f"eclipse/zenoh:{zenoh}"


def test_the_stations_key_neither_replaces_nor_removes_recordings() -> None:
    policy = json.loads((CLUSTER / "station-policy.json").read_text())
    assert [each["Action"] for each in policy["Statement"]] == [["s3:PutObject", "s3:GetObject", "s3:ListBucket"]]


@pytest.mark.parametrize("file", ["compose.yaml", "compose-site.yaml"])
def test_compose_takes_it(file: str) -> None:
    known = json.loads(COMPOSE.read_text()) | {"$schema": jsonschema.Draft202012Validator.META_SCHEMA["$schema"]}
    document = yaml.safe_load((DEPLOY / file).read_text())
    assert [error.message for error in jsonschema.Draft202012Validator(known).iter_errors(document)] == []


def test_the_cells_of_compose_are_apart_on_one_store() -> None:
    loaded = {}
    for name in ("cell-1", "cell-2", "cell-3", "worker"):
        with variables(SITE["services"][name]["environment"]):
            loaded[name] = load()
    cells = [loaded[f"cell-{number}"] for number in (1, 2, 3)]
    for apart in ("bus.endpoint", "bus.prefix", "web.port", "store.station"):
        room, setting = apart.split(".")
        assert len({getattr(getattr(each, room), setting) for each in cells}) == 3, apart
    assert loaded["worker"].store.station == "cell-1"
    assert len({(each.store.database, each.store.recordings) for each in loaded.values()}) == 1
    for each in cells:
        require_safe_binding(each.auth.mode, each.web.host, each.web.hosts, each.web.proxies)


@pytest.mark.parametrize(
    "words", [pod["containers"][0]["args"] for name, pod in PODS.items() if name in ("cell", "worker")], ids=" ".join
)
def test_the_commands_exist_with_their_options(words: list[str]) -> None:
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    known = {option for one in commands[words[0]].params for option in one.opts}
    assert {word for word in words if word.startswith("--")} <= known
