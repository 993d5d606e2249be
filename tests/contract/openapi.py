"""The description of the REST API: `python -m tests.contract.openapi` writes openapi.json after a wanted change.

It writes the client's models with it.
"""

import json
import sys
from pathlib import Path
from typing import Any

from tests.contract import client_models
from tests.contract.stations import station

FILE = Path(__file__).with_suffix(".json")


def text(description: dict[str, Any]) -> str:
    """Return the description as the file holds it: without the version, which changes by itself."""
    info = {key: value for key, value in description["info"].items() if key != "version"}
    return json.dumps(description | {"info": info}, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    with station() as opened:
        FILE.write_text(text(opened.web.openapi()))
        client_models.FILE.write_text(client_models.text(opened.web.openapi()))
    sys.stdout.write(f"{FILE} and {client_models.FILE} written\n")
