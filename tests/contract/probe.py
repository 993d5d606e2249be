"""Schemathesis at a station, as every role and as all of them (`make probe-contract`).

It sends what it makes of the station's own description, right and wrong, and holds every answer against it. It is no
part of `make test`: it takes minutes, and finds less from day to day than the tests that walk the description.
"""

import os
import subprocess
import sys
from pathlib import Path

from teachpath.records import Capability
from tests.contract.guarded import opened

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / ".venv" / "contract" / "bin" / "schemathesis"
CONFIG = ROOT / "tools" / "contract" / "schemathesis.toml"
FOLDER = ROOT / "dist" / "probe"  # it keeps what it has learned beside the place where it runs
NO_LIMIT = {"request_rate": 1e6, "request_burst": 1_000_000, "max_requests": 10_000, "max_uploads": 1000}


def main() -> None:
    """Probe as each role, and end with status 1 when something was found; arguments go to Schemathesis."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with opened(**NO_LIMIT) as station:
        station.a_path()
        tokens = {"all": station.make("all", *Capability)} | {role.value: t for role, t in station.tokens.items()}
        found = [name for name, token in tokens.items() if not is_clean(name, station.url, token)]
    if found:
        sys.exit(f"findings as {', '.join(found)}: see above")


def is_clean(name: str, url: str, token: str) -> bool:
    """Tell whether nothing was found with a token."""
    print(f"as {name}:", flush=True)
    words = ["run", f"{url}/openapi.json", "--url", url, "--header", f"Authorization: Bearer {token}"]
    options = ["--phases", "examples,coverage,stateful", "--max-examples", "3", "--workers", "1", "--warnings", "off"]
    command = [PROGRAM, "--config-file", CONFIG, *words, *options, "--continue-on-failure", *sys.argv[1:]]
    return subprocess.run(command, cwd=FOLDER, env=os.environ | {"NO_COLOR": "1"}, check=False).returncode == 0


if __name__ == "__main__":
    main()
