"""Which authorities this user's programs trust to vouch for stations, beside those that the system trusts."""

from __future__ import annotations

import ssl
from pathlib import Path

from teachpath_proto.tokens import token_path


def authorities_folder() -> Path:
    """Return the folder of their certificates, NAME.pem, in this user's state folder (XDG_STATE_HOME)."""
    return token_path("").parent / "authorities"


def trusted_authorities(url: str) -> ssl.SSLContext | None:
    """Return what a connection to `url` trusts; None where it is not over TLS.

    A file that is no certificate is passed over: it could only make somebody trusted.
    """
    if not url.startswith(("https:", "wss:")):
        return None
    context = ssl.create_default_context()
    for file in sorted(authorities_folder().glob("*.pem")):
        try:
            context.load_verify_locations(file)
        except (OSError, ValueError):
            continue
    return context
