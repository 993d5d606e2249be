"""What a process beside the service is given: settings, arm, login and key, as one line of JSON."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field

from teachpath.config import Settings, load
from teachpath.io.documents import from_document, to_document
from teachpath.records import SerialArm
from teachpath_proto.logins import Login, Role


@dataclass(frozen=True)
class Instructions:
    """What a process beside the service is given through its standard input, and nowhere else.

    Attributes:
        settings: of the station, with the model of its arm.
        login: on the bus; None without access control.
        signing_key: of the station, for the executor alone; empty for others.
    """

    settings: Settings
    login: Login | None
    signing_key: bytes = field(default=b"", repr=False)


def instructions(given: Instructions) -> str:
    """Write one line of JSON for a process beside the service."""
    settings, model = given.settings.model_dump(mode="json"), given.settings.model
    document = {
        "settings": settings,
        "model": to_document(model) if model else None,
        "login": asdict(given.login) if given.login else None,
        "signing_key": given.signing_key.hex(),
    }
    return json.dumps(document)


def from_instructions(line: str) -> Instructions:
    """Read what `instructions` wrote."""
    document = json.loads(line)
    login, model = document["login"], document["model"]
    settings = load(document=document["settings"])
    return Instructions(
        settings.with_model(from_document(SerialArm, model)) if model else settings,
        Login(**{**login, "role": Role(login["role"])}) if login else None,
        bytes.fromhex(document["signing_key"]),
    )
