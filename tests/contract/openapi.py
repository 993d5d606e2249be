"""The description of the REST API: `python -m tests.contract.openapi` writes openapi.json after a wanted change.

It writes the client's models with it. `python -m tests.contract.openapi FILE` writes the description as a station gives
it into a file, for linters and generators, and nothing else.
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
        description = opened.web.openapi()
    if sys.argv[1:]:
        written = [Path(sys.argv[1])]
        written[0].parent.mkdir(exist_ok=True)
        written[0].write_text(json.dumps(description, indent=1))
    else:
        written = [FILE, client_models.FILE]
        FILE.write_text(text(description))
        client_models.FILE.write_text(client_models.text(description))
    sys.stdout.write(f"{' and '.join(map(str, written))} written\n")
