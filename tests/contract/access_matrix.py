"""Who may use which route and which key of the bus: `python -m tests.contract.access_matrix` writes docs/access.md."""

import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import zenoh
from fastapi import FastAPI, params
from fastapi.routing import APIRoute, APIWebSocketRoute, RouteContext, iter_route_contexts

from teachpath.api.access import authorize, let_pass
from teachpath.io.bus_access import GRANTS
from teachpath.records import ROLES, Capability
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role
from tests.contract.stations import station

FILE = Path(__file__).parents[2] / "docs" / "access.md"
BEGIN, END = "<!-- generated -->\n", "<!-- end -->\n"
KEYS = Keys()
LOGINS = [role for role in Role if role not in (Role.SERVICE, Role.ROUTER)]  # of programs beside the station itself
ABOUT_KEYS = """On the bus (Zenoh) a program has a login of a role: `tracker` demonstrates, `operator` operates,
`viewer` views; `executor` and `robot` are parts of the station. What stands here, below the station's prefix, is let
through, and nothing else; a tracker or robot that is held to one name has the keys of that name alone. The service
itself, which answers under `recorder` and `station`, and tells `jobs` and `feedback`, may do everything."""
NO_ROLE = "none"  # what a route needs that is open to everybody


def declarations(context: RouteContext) -> list[str]:
    """Return what a route declares to need: one capability, or none; an empty list where it says nothing."""
    route = context.original_route
    found: list[str] = []
    for one in route.dependencies if isinstance(route, APIRoute | APIWebSocketRoute) else ():
        if one.dependency is authorize:
            assert isinstance(one, params.Security)
            found += list(one.scopes)
        elif one.dependency is let_pass:
            found.append(NO_ROLE)
    return found


def needs(app: FastAPI) -> Iterator[tuple[str, str, str]]:
    """Yield method, path and need of every route, WebSockets as WS."""
    for route in iter_route_contexts(app.routes):
        for method in sorted(route.methods or ["WS"]):
            yield method, route.path or "", ", ".join(declarations(route))


def keys() -> list[str]:
    """Return every key of a station below its prefix, a name in braces where a key has one."""
    found = [key for name, key in vars(KEYS).items() if name != "prefix" and not name.startswith("all_")]
    names = {"tracker": "{tracker}", "scene": "{scene}", "robot": "{robot}", "job": "{job}"}
    for name, make in inspect.getmembers(KEYS, inspect.ismethod):
        parameters = list(inspect.signature(make).parameters)
        if len(parameters) == 1 and parameters[0] in names:
            found.append(make(names[parameters[0]]))
        else:
            assert name in ("__init__", "alive", "tracker_of", "scene_of", "announced"), f"which keys has {name}?"
    found += [KEYS.alive(kind, f"{{{kind}}}") for kind in ("tracker", "robot", "executor")]
    return sorted(key.removeprefix(f"{KEYS.prefix}/") for key in found)


def granted(role: Role, key: str) -> list[str]:
    """Return what a login of a role may do with a key; where it is held to one name, with that of the name."""
    return [verb for verb, patterns in GRANTS[role].items() if any(matches(pattern, key) for pattern in patterns)]


def matches(pattern: str, key: str) -> bool:
    """Tell whether a grant is for a key."""
    expression = pattern.replace("{only}", "*")
    return zenoh.KeyExpr(expression).includes(zenoh.KeyExpr(re.sub(r"\{(.*?)\}", r"\1", key)))


def text(app: FastAPI) -> str:
    """Return the page as it should be: its own words, and the matrix in its place."""
    before, _, rest = FILE.read_text().partition(BEGIN)
    return before + BEGIN + _tables(app) + END + rest.partition(END)[2]


def _tables(app: FastAPI) -> str:
    roles = [f"| {role} | {' | '.join('yes' if c in ROLES[role] else '' for c in Capability)} |" for role in ROLES]
    head = f"| role | {' | '.join(Capability)} |\n|---|{'---|' * len(Capability)}\n"
    routes = sorted({(path, method, need) for method, path, need in needs(app)})
    rows = [f"| {method} | `{path}` | {need} |" for path, method, need in routes]
    of_bus = [f"| `{key}` | {' | '.join(', '.join(granted(role, key)) for role in LOGINS)} |" for key in keys()]
    bus_head = f"| key | {' | '.join(LOGINS)} |\n|---|{'---|' * len(LOGINS)}\n"
    return (
        head + "\n".join(roles) + "\n\n| method | route | needs |\n|---|---|---|\n" + "\n".join(rows) + "\n\n"
        f"{ABOUT_KEYS}\n\n{bus_head}" + "\n".join(of_bus) + "\n"
    )


if __name__ == "__main__":
    with station() as opened:
        FILE.write_text(text(opened.web))
    sys.stdout.write(f"{FILE} written\n")
