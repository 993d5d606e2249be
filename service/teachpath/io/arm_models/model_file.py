"""A file in URDF or MJCF as a compiled MuJoCo model, with what MuJoCo does not read of a URDF."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, TypeVar
from xml.etree import ElementTree

import mujoco
import numpy as np

from teachpath.errors import UnusableInput

T = TypeVar("T")

MAX_SIZE: Final = 20_000_000  # bytes
XACRO: Final = re.compile(r"<xacro:|\$\{|\$\(")
MESH_SUFFIXES: Final = (".stl", ".obj", ".msh")


@dataclass(frozen=True)
class UrdfJoint:
    """What a URDF says of a joint and MuJoCo does not read; None where it says nothing."""

    speed: float | None = None
    effort: float | None = None
    mimics: str | None = None


@dataclass(frozen=True, eq=False)
class ModelFile:
    """A model, compiled by MuJoCo.

    Attributes:
        path: of the file.
        model: with a body for every link.
        urdf_joints: by name; empty for MJCF.
    """

    path: Path
    model: mujoco.MjModel
    urdf_joints: dict[str, UrdfJoint] = field(default_factory=dict)


def read_model_file(path: Path) -> ModelFile:
    """Read and compile a model.

    Raises:
        UnusableInput: it cannot be read, or is no model that MuJoCo compiles; the sentence says what to change.
    """
    text = _text(path)
    if path.suffix == ".xacro" or XACRO.search(text):
        raise UnusableInput(
            f"{path} is a xacro that was not expanded: write xacro {path.name} > arm.urdf, and add that"
        )
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise UnusableInput(f"{path} is no XML: {error}; add a model in URDF or MJCF") from None
    if root.tag == "robot":
        joints = _urdf_joints(root, path)
        spec = _urdf(root, path)
    elif root.tag == "mujoco":
        joints, spec = {}, _parsed(lambda: mujoco.MjSpec.from_file(str(path)), path)
    else:
        raise UnusableInput(f"{path} begins with <{root.tag}>; a URDF begins with <robot>, an MJCF with <mujoco>")
    if not spec.joints:
        raise UnusableInput(f"{path} has no joints; add the model of an arm (a xacro has to be expanded first)")
    _check_inertia(spec, path)
    return ModelFile(path, _parsed(spec.compile, path), joints)


def _text(path: Path) -> str:
    try:
        if (size := path.stat().st_size) > MAX_SIZE:
            raise UnusableInput(f"{path} has {size} bytes, limit {MAX_SIZE}; a model names its meshes in other files")
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise UnusableInput(f"cannot read the model {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UnusableInput(f"{path} is no text in UTF-8; add a model in URDF or MJCF") from None
    if "<!ENTITY" in text:
        raise UnusableInput(f"{path} declares entities of XML; write out what they stand for")
    return text


def _parsed(make: Callable[[], T], path: Path) -> T:
    try:
        return make()
    except ValueError as error:
        said = " ".join(str(error).removeprefix("Error: ").split())
        if "mass and inertia of moving bodies" in said:
            said += "; give the link an <inertial> with the mass and moments of the real one"
        raise UnusableInput(f"MuJoCo cannot use {path}: {said}") from None


def _urdf(root: ElementTree.Element, path: Path) -> mujoco.MjSpec:
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(_mesh_file(mesh.get("filename", ""), path)))
    for extension in root.findall("mujoco"):
        root.remove(extension)  # its settings would change what is read below
    spec = _parsed(lambda: mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode")), path)
    spec.compiler.fusestatic = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.strippath = False
    return spec


def _mesh_file(name: str, model: Path) -> Path:
    """Return the file of a mesh that a URDF names by path, `file://` or `package://`."""
    folder = model.resolve().parent
    if name.startswith("package://"):
        package, _, rest = name.removeprefix("package://").partition("/")
        roots = [above / package for above in (folder, *folder.parents)]
        roots += [above for above in (folder, *folder.parents) if above.name == package]
        found = next((root / rest for root in roots if (root / rest).is_file()), None)
        if found is None:
            raise UnusableInput(
                f"{model}: {name} leads nowhere: no folder {package} beside or above the model has {rest}; put the "
                f"package {package} there, or write the mesh's path"
            )
    else:
        found = folder / name.removeprefix("file://")
    if not found.is_file():
        raise UnusableInput(f"{model}: the mesh {name} is missing ({found}); put it there, or write where it is")
    if found.suffix.lower() not in MESH_SUFFIXES:
        raise UnusableInput(
            f"{model}: the mesh {name} ends in {found.suffix!r}; a <collision> takes {', '.join(MESH_SUFFIXES)}"
        )
    return found


def _urdf_joints(root: ElementTree.Element, path: Path) -> dict[str, UrdfJoint]:
    joints, parents = {}, dict[str, str]()
    for joint in root.findall("joint"):
        name, child, limit, mimic = joint.get("name", ""), joint.find("child"), joint.find("limit"), joint.find("mimic")
        link = "" if child is None else child.get("link", "")
        if link in parents:
            raise UnusableInput(
                f"{path}: joints {parents[link]} and {name} both move {link}: a closed loop; only chains are planned, "
                "so leave out one of the two"
            )
        parents[link] = name
        limits = {} if limit is None else limit.attrib
        joints[name] = UrdfJoint(
            _number(limits.get("velocity"), name, path),
            _number(limits.get("effort"), name, path),
            None if mimic is None else mimic.get("joint", ""),
        )
    return joints


def _number(text: str | None, joint: str, path: Path) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        raise UnusableInput(f"{path}: a limit of joint {joint} is {text!r}; write a number") from None


def _check_inertia(spec: mujoco.MjSpec, path: Path) -> None:
    """Refuse moments of inertia that no body has: none is below zero or above the sum of the other two."""
    for body in spec.bodies:
        if not body.explicitinertial:
            continue
        full = np.array(body.fullinertia)
        xx, yy, zz, xy, xz, yz = full if np.isfinite(full).all() else (*body.inertia, 0.0, 0.0, 0.0)
        moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if moments[0] < 0.0 or moments[2] > (moments[0] + moments[1]) * (1.0 + 1e-9):
            said = ", ".join(f"{moment:.4g}" for moment in moments)
            raise UnusableInput(
                f"{path}: link {body.name} has principal moments of inertia {said} kg m^2; no body has one below zero "
                "or above the sum of the other two: write those of the real link"
            )
