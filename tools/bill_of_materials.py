"""The bill of materials of a station in CycloneDX: `make sbom` writes it to dist/.

Python packages are those that requirements/service.txt pins, with the hashes of their files; browser libraries those
that clients/web/vendor/README.md names, with the hash of each file that is served.
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Final

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import HashAlgorithm, HashType, Property
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output import make_outputter
from cyclonedx.schema import OutputFormat, SchemaVersion
from packageurl import PackageURL

ROOT: Final = Path(__file__).parents[1]
PROJECT: Final = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PINS_FILE: Final = ROOT / "requirements" / "service.txt"
VENDOR_FOLDER: Final = ROOT / "clients" / "web" / "vendor"
PIN: Final = re.compile(
    r"^([a-z0-9-]+)==([^ ]+)(?: ; ([^\\\n]+?))?((?: \\\n? +--hash=sha256:[0-9a-f]{64})+)", re.MULTILINE
)
ROW: Final = re.compile(r"^\| ([a-z-]+) \| ([a-z-]+)[^|]*\| ([\d.]+) \| ([\w.-]+)", re.MULTILINE)
FILE: Final = ROOT / "dist" / "teachpath.cdx.json"


def bill() -> Bom:
    """Return the bill of materials: the service, and all that it is made of."""
    name, version = PROJECT["name"], PROJECT["version"]
    service = _component(name, version, PackageURL("pypi", None, name, version), PROJECT["license"])
    service.type = ComponentType.APPLICATION
    parts = [*_packages(), *_browser_libraries()]
    bom = Bom(components=parts)
    bom.metadata.component = service
    bom.register_dependency(service, parts)
    return bom


def text() -> str:
    """Return it as JSON."""
    return str(make_outputter(bill(), OutputFormat.JSON, SchemaVersion.V1_6).output_as_string(indent=2))


def _packages() -> Iterator[Component]:
    for name, version, marker, hashes in PIN.findall(PINS_FILE.read_text()):
        part = _component(name, version, PackageURL("pypi", None, name, version), _license_of(name))
        part.hashes.update(HashType(alg=HashAlgorithm.SHA_256, content=h) for h in re.findall(r"[0-9a-f]{64}", hashes))
        if marker:
            part.properties.add(Property(name="teachpath:marker", value=marker))  # on some systems alone
        yield part


def _browser_libraries() -> Iterator[Component]:
    for folder, name, version, licence in ROW.findall((VENDOR_FOLDER / "README.md").read_text()):
        part = _component(name, version, PackageURL("npm", None, name, version), licence)
        part.components.update(_file(file) for file in sorted((VENDOR_FOLDER / folder).glob("*")))
        yield part


def _file(file: Path) -> Component:
    content = hashlib.sha256(file.read_bytes()).hexdigest()
    return Component(
        name=str(file.relative_to(VENDOR_FOLDER)),
        type=ComponentType.FILE,
        bom_ref=f"file:{file.relative_to(VENDOR_FOLDER)}",
        hashes=[HashType(alg=HashAlgorithm.SHA_256, content=content)],
    )


def _component(name: str, version: str, url: PackageURL, licence: str) -> Component:
    made = LicenseFactory().make_from_string(licence) if licence else None
    return Component(
        name=name,
        version=version,
        type=ComponentType.LIBRARY,
        purl=url,
        bom_ref=str(url),
        licenses=[made] if made else [],
    )


def _license_of(name: str) -> str:
    """Return what an installed package says of its licence; empty where it is not installed, or says a whole text."""
    try:
        said = metadata(name)
    except PackageNotFoundError:  # of another system
        return ""
    expression = said.get("License-Expression") or said.get("License") or ""
    classified = [each.rpartition(" :: ")[2] for each in said.get_all("Classifier") or [] if "License ::" in each]
    return expression if expression and len(expression) < 60 else next(iter(classified), "")


if __name__ == "__main__":
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(text())
    print(f"{FILE.relative_to(ROOT)}: {len(bill().components)} parts")
