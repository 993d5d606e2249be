"""deploy/zenohd.json5 as it follows from the table of roles: `python -m tests.contract.router_file` writes it."""

from pathlib import Path

from teachpath.io.bus_settings import BusSettings
from teachpath.io.router_config import router_config
from teachpath_proto.logins import Login, Role

FILE = Path(__file__).parents[2] / "deploy" / "zenohd.json5"


def text() -> str:
    """Return the whole file: every role once, as `teachpath station certificates` makes them."""
    bus = BusSettings("tls/127.0.0.1:7447", mode="client")
    return router_config(bus, [Login(role.value, "", role, certificate="in its folder") for role in Role])


if __name__ == "__main__":
    FILE.write_text(text())
