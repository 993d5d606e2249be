"""Documents are sent compressed to whom takes them so, and are the same documents."""

import asyncio
import gzip
from collections.abc import AsyncIterator

import pytest
from fastapi import FastAPI, Response
from fastapi.responses import StreamingResponse
from httpx import ASGITransport, AsyncClient
from httpx import Response as Answer

from teachpath.api.compressed_documents import LEAST_COMPRESSED, CompressedDocuments

LONG_DOCUMENT = [{"number": k} for k in range(LEAST_COMPRESSED)]


def application() -> FastAPI:
    app = FastAPI()
    app.add_middleware(CompressedDocuments)
    app.add_api_route("/long", lambda: LONG_DOCUMENT)
    app.add_api_route("/long", lambda: LONG_DOCUMENT, methods=["POST"])
    app.add_api_route("/short", lambda: [1])
    app.add_api_route("/text", lambda: Response("x" * 5000, media_type="text/plain"))

    async def pieces() -> AsyncIterator[bytes]:
        yield b"[1,"
        yield b"2]"

    app.add_api_route("/pieces", lambda: StreamingResponse(pieces(), media_type="application/json"))
    return app


def ask(method: str, path: str, takes: str) -> Answer:
    async def answer() -> Answer:
        async with AsyncClient(transport=ASGITransport(application()), base_url="http://127.0.0.1") as client:
            return await client.request(method, path, headers={"Accept-Encoding": takes})

    return asyncio.run(answer())


@pytest.mark.parametrize(
    ("method", "path", "takes", "encoding"),
    [
        ("GET", "/long", "gzip", "gzip"),
        ("GET", "/long", "identity", None),
        ("POST", "/long", "gzip", None),
        ("GET", "/short", "gzip", None),
        ("GET", "/text", "gzip", None),
        ("GET", "/pieces", "gzip", None),
    ],
)
def test_a_long_document_is_compressed(method: str, path: str, takes: str, encoding: str | None) -> None:
    plain, answer = ask(method, path, "identity"), ask(method, path, takes)
    assert answer.headers.get("content-encoding") == encoding
    assert answer.content == plain.content
    if encoding:
        assert int(answer.headers["content-length"]) == len(gzip.compress(plain.content, 6, mtime=0))
        assert int(answer.headers["content-length"]) < len(plain.content) / 2
    if answer.headers["content-type"] == "application/json" and method == "GET":
        assert answer.headers["vary"] == "Accept-Encoding"
