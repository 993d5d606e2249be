"""The pinned requirements: everything that is asked for has a version and hashes, and no address."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
FILES = {name: (ROOT / "requirements" / f"{name}.txt").read_text() for name in ("service", "site", "dev", "uv")}
REQUIREMENT_FILES = {  # in environments of their own
    name: (ROOT / "requirements" / f"{name}.txt").read_text() for name in ("contract", "generators")
}


def pinned(text: str) -> list[str]:
    """Return the names of the distributions that a requirements file pins."""
    return [name for name, _, _ in pins(text)]


def pins(text: str) -> list[tuple[str, str, str]]:
    """Return name, version and marker of each distribution that a requirements file pins."""
    return re.findall(r"^([a-z0-9-]+)==([^ ]+) (?:; ([^\\]+))?", text, re.MULTILINE)


def wanted(*lists: list[str]) -> set[str]:
    """Return the names of the distributions in lists of requirements, as they are written in a pinned file."""
    names = (re.match(r"[A-Za-z0-9._-]+", requirement) for asked in lists for requirement in asked)
    return {re.sub(r"[-_.]+", "-", name[0]).lower() for name in names if name}


@pytest.mark.parametrize("text", [*FILES.values(), *REQUIREMENT_FILES.values()], ids=[*FILES, *REQUIREMENT_FILES])
def test_every_requirement_is_a_version_with_hashes_and_nothing_else(text: str) -> None:
    lines = text.replace("\\\n", "").splitlines()
    assert lines
    for line in lines:
        assert re.fullmatch(r"[a-z0-9-]+==[\w.]+( ; [^;@]+?)?( +--hash=sha256:[0-9a-f]{64})+ *", line), line[:100]


def test_everything_that_is_asked_for_is_pinned() -> None:
    extras, groups = PYPROJECT["project"]["optional-dependencies"], PYPROJECT["dependency-groups"]
    service, site, dev = (set(pinned(FILES[name])) for name in ("service", "site", "dev"))
    assert wanted(PYPROJECT["project"]["dependencies"], extras["service"], groups["build"]) <= service
    assert wanted(extras["postgres"], extras["s3"]) <= service | site
    assert (
        wanted(extras["dev"], extras["dask"], extras["formats"], extras["lerobot"], extras["ros"])
        <= service | site | dev
    )
    assert wanted(groups["setup"]) == set(pinned(FILES["uv"]))
    for name, text in REQUIREMENT_FILES.items():
        assert wanted(groups[name]) <= set(pinned(text))


def test_a_distribution_is_pinned_in_one_place() -> None:
    """What the service needs on some systems alone stands again where the tools need it on all, in the same version."""
    everywhere = [name for text in FILES.values() for name, _, marker in pins(text) if not marker]
    assert len(everywhere) == len(set(everywhere))
    versions = {(name, version) for text in FILES.values() for name, version, _ in pins(text)}
    assert len(versions) == len({name for name, _ in versions})


def test_what_only_the_server_of_meshcat_needs_is_left_out() -> None:
    (meshcat,) = PYPROJECT["tool"]["uv"]["dependency-metadata"]
    assert f"{meshcat['name']}=={meshcat['version']}" in PYPROJECT["project"]["optional-dependencies"]["service"]
    assert not {"ipython", "jedi", "pyngrok", "pyzmq"} & set(pinned(FILES["service"] + FILES["dev"]))
    assert "tornado" not in pinned(FILES["service"])  # the tests have it of Dask
