"""A program that hears numbered messages and tells which when it is asked: ENDPOINT KEY."""

import sys
import threading

from teachpath_proto.sessions import joining, open_session


def main(endpoint: str, key: str) -> None:
    """Hear and tell until the process is killed."""
    heard: list[bytes] = []
    session = open_session(joining(endpoint, None, timeout=60.0))
    declared = (  # each is taken back when nothing refers to it any more
        session.declare_subscriber(key, lambda sample: heard.append(sample.payload.to_bytes()[:8])),
        session.declare_queryable(f"{key}/heard", lambda query: query.reply(f"{key}/heard", b"".join(heard))),
        session.liveliness().declare_token(f"{key}/alive"),
    )
    threading.Event().wait()
    del declared


if __name__ == "__main__":
    main(*sys.argv[1:])
