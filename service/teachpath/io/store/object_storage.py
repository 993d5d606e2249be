"""Object storage: recordings as objects of a bucket, over the protocol S3.

Where its server is and who asks is in the environment, as every client of S3 reads it: AWS_ENDPOINT_URL, AWS_REGION,
AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY.
"""

from __future__ import annotations

import asyncio
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final

from teachpath.errors import NotFound, StorageFull, StorageUnavailable, TeachpathError, UnusableSettings

if TYPE_CHECKING:
    from obstore.store import S3Store

SCHEME: Final = "s3://"
URL: Final = re.compile(r"s3://([a-z0-9][a-z0-9.-]{1,61}[a-z0-9])((?:/[\w-][\w.-]*)*)", re.ASCII)
CONNECT_TIMEOUT: Final = timedelta(seconds=5)
READ_TIMEOUT: Final = timedelta(seconds=20)  # without a byte
UPLOAD_GRACE: Final = 30.0  # [s] that an upload may take, and more:
SLOWEST_LINE: Final = 10_000.0  # bytes in a second
LOOK_INTERVAL: Final = 0.1  # [s] in which an upload that is to be given up goes on
FULL_STORAGE_CODES: Final = (
    "XMinioStorageFull",
    "XMinioAdminBucketQuotaExceeded",
    "QuotaExceeded",
    "InsufficientCapacity",
)


def is_address(place: str) -> bool:
    """Return whether a demonstration's `recording` names an object, not a file."""
    return place.startswith(SCHEME)


def check_url(url: str) -> None:
    """Raise UnusableSettings when a setting `store.recordings` is no place for objects."""
    if not URL.fullmatch(url):
        raise UnusableSettings(
            f"setting store.recordings is {url!r}; it should be s3://BUCKET or s3://BUCKET/PREFIX, or empty for the "
            "data folder; where the server is, and its keys, are in the environment (AWS_ENDPOINT_URL, "
            "AWS_ACCESS_KEY_ID ...)"
        )


class ObjectStorage:
    """The objects below a URL, and how to read any other.

    Args:
        url: `s3://BUCKET/PREFIX` of the objects that are written; empty: none are.

    Raises:
        UnusableSettings: a URL is given, and the client is not installed.
    """

    def __init__(self, url: str = "") -> None:
        self.url: str = url.rstrip("/")
        self._clients: dict[str, S3Store] = {}
        if url:
            _require_client()

    def __getstate__(self) -> dict[str, Any]:
        return {"url": self.url, "_clients": {}}  # a process has connections of its own

    def address(self, place: str) -> str:
        """Return the address of the object of a recording."""
        return f"{self.url}/{place}"

    def place(self, address: str) -> str:
        """Return the place of the recording whose object has this address."""
        return address.removeprefix(f"{self.url}/")

    def read(self, address: str) -> bytes:
        """Return the content of an object.

        Raises:
            NotFound: there is none.
            StorageUnavailable: the server does not answer, or refuses.
        """
        client, key = self._found(address)
        with _explained(address):
            import obstore

            return bytes(obstore.get(client, key).bytes())

    def put_new(self, address: str, content: bytes, is_stopped: Callable[[], bool]) -> bool:
        """Store an object whole, with its SHA-256 for the server to compare, where there is none.

        Args:
            address: of the object.
            content: of it.
            is_stopped: whether to give the upload up; asked while it is under way.

        Returns:
            False: there is an object already.

        Raises:
            StorageFull: the bucket has no room.
            StorageUnavailable: the server does not answer, refuses, or takes too long; it was given up.
        """
        client, key = self._found(address)
        with _explained(address):
            from obstore.exceptions import AlreadyExistsError

            try:
                asyncio.run(_upload(client, key, content, is_stopped))
            except AlreadyExistsError:
                return False
        return True

    def listed(self) -> Iterator[str]:
        """Yield the addresses of the objects below the URL; raises StorageUnavailable."""
        client, prefix = self._found(self.url)
        with _explained(self.url):
            import obstore

            for batch in obstore.list(client, prefix):
                for entry in batch:
                    yield f"{SCHEME}{self.url.removeprefix(SCHEME).partition('/')[0]}/{entry['path']}"

    def _found(self, address: str) -> tuple[S3Store, str]:
        """Return the client of the bucket of an object, and the object's key."""
        bucket, _, key = address.removeprefix(SCHEME).partition("/")
        if bucket not in self._clients:
            _require_client()
            self._clients[bucket] = _client(bucket)
        return self._clients[bucket], key


def _require_client() -> None:
    if find_spec("obstore") is None:
        raise UnusableSettings(
            "recordings in object storage need obstore, which is not installed: pip install 'teachpath[s3]'"
        )


def _client(bucket: str) -> S3Store:
    from obstore.store import S3Store

    plain = os.environ.get("AWS_ENDPOINT_URL", "").startswith("http://")  # then somebody has asked for it
    return S3Store(
        bucket,
        config={"checksum_algorithm": "SHA256"},
        client_options={
            "allow_http": plain,
            "connect_timeout": CONNECT_TIMEOUT,
            "read_timeout": READ_TIMEOUT,
            "timeout": timedelta(days=1),
        },
        retry_config={"max_retries": 1, "retry_timeout": READ_TIMEOUT},
    )


async def _upload(client: S3Store, key: str, content: bytes, is_stopped: Callable[[], bool]) -> None:
    import obstore

    loop = asyncio.get_running_loop()
    deadline = loop.time() + UPLOAD_GRACE + len(content) / SLOWEST_LINE
    upload = asyncio.ensure_future(obstore.put_async(client, key, content, mode="create", use_multipart=False))
    while not (await asyncio.wait({upload}, timeout=LOOK_INTERVAL))[0]:
        if is_stopped() or loop.time() > deadline:
            upload.cancel()
            raise StorageUnavailable(f"the upload of {len(content)} bytes was given up; the line is slow, or cut")
    await upload


@contextmanager
def _explained(address: str) -> Iterator[None]:
    """Raise what the client raises as what it says to the operator."""
    from obstore.exceptions import BaseError

    try:
        yield
    except (BaseError, FileNotFoundError) as error:
        raise _fault(error, address) from None


def _fault(error: Exception, address: str) -> TeachpathError:
    from obstore.exceptions import PermissionDeniedError, UnauthenticatedError

    bucket, said = "/".join(address.split("/")[:3]), str(error)
    code = found[1] if (found := re.search(r"<Code>(\w+)</Code>", said)) else ""
    if code in FULL_STORAGE_CODES or "507 Insufficient" in said:
        return StorageFull(f"{bucket} has no room ({code}); free space there, or raise its quota")
    if code == "NoSuchBucket":
        return StorageUnavailable(f"there is no bucket {bucket}; make it, or name another in store.recordings")
    if isinstance(error, FileNotFoundError):
        return NotFound(f"there is no object {address}; run: teachpath doctor")
    if isinstance(error, (PermissionDeniedError, UnauthenticatedError)):
        return StorageUnavailable(
            f"{bucket} is refused ({code or 'no reason given'}); look at AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, "
            "and at what they may do"
        )
    if "169.254.169.254" in said:  # where machines of a cloud ask who they are
        return StorageUnavailable(f"nobody says who asks for {bucket}; set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY")
    reason = said.partition("\n")[0].rpartition(" - ")[2]
    return StorageUnavailable(
        f"{bucket} does not answer ({reason}); is AWS_ENDPOINT_URL right, and its server running?"
    )
