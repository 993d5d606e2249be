"""The bill of materials: valid by its schema, and everything that a station is made of is in it."""

import hashlib
import json
from typing import Any

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from tools import bill_of_materials

from tests.contract.test_requirements import FILES, pins

VALIDATOR = JsonStrictValidator(SchemaVersion.V1_6)


@pytest.fixture(scope="module")
def bill() -> dict[str, Any]:
    document: dict[str, Any] = json.loads(bill_of_materials.text())
    return document


def test_it_is_valid_by_the_schema_of_cyclonedx(bill: dict[str, Any]) -> None:
    assert VALIDATOR.validate_str(json.dumps(bill)) is None
    assert VALIDATOR.validate_str(json.dumps(bill | {"components": [{"name": "of no type"}]})) is not None


def test_it_has_every_pinned_package_with_all_its_hashes(bill: dict[str, Any]) -> None:
    packages = {part["name"]: part for part in bill["components"] if part["purl"].startswith("pkg:pypi/")}
    assert {(name, part["version"]) for name, part in packages.items()} == {
        (name, version) for name, version, _ in pins(FILES["service"])
    }
    hashes = [found["content"] for part in packages.values() for found in part["hashes"]]
    assert len(hashes) == FILES["service"].count("--hash=sha256:")
    said = [part for part in packages.values() if part.get("licenses")]
    assert len(said) > 0.8 * len(packages)


def test_it_has_every_vendored_browser_library_file_by_file(bill: dict[str, Any]) -> None:
    libraries = [part for part in bill["components"] if part["purl"].startswith("pkg:npm/")]
    folders = {folder.name for folder in bill_of_materials.VENDOR_FOLDER.iterdir() if folder.is_dir()}
    files = {file["name"]: file["hashes"][0]["content"] for part in libraries for file in part["components"]}
    assert {name.partition("/")[0] for name in files} == folders
    for folder in folders:
        for file in (bill_of_materials.VENDOR_FOLDER / folder).iterdir():
            assert files[f"{folder}/{file.name}"] == hashlib.sha256(file.read_bytes()).hexdigest()
    assert all(part["licenses"] for part in libraries)


def test_it_is_of_this_version_and_depends_on_all_of_them(bill: dict[str, Any]) -> None:
    service = bill["metadata"]["component"]
    assert (service["name"], service["version"]) == ("teachpath", bill_of_materials.PROJECT["version"])
    (of_service,) = [each for each in bill["dependencies"] if each["ref"] == service["bom-ref"]]
    assert set(of_service["dependsOn"]) == {part["bom-ref"] for part in bill["components"]}
