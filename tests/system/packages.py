"""A review package in a browser, opened from its file."""

import json
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from tests.waiting import HANG


class Package:
    """An open package; at its end nothing may have been said, asked for or refused."""

    def __init__(self, browser: Any, file: Path) -> None:
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page = browser.new_page(viewport={"width": 1100, "height": 800})
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("websocket", lambda socket: self.asked.append(socket.url))
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("dialog", self._refuse)
        self.page.goto(file.as_uri())
        self.page.wait_for_selector("html[data-report=ready]", state="attached", timeout=1000 * HANG)

    def archive(self) -> dict[str, Any]:
        """Return the documents that it holds, by their paths."""
        archive: dict[str, Any] = json.loads(self.page.locator("#archive").text_content())
        return archive

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.page.close()
        if kind is None:
            elsewhere = [url for url in self.asked if not url.startswith(("file:", "data:", "blob:"))]
            assert (self.said, elsewhere) == ([], [])

    def _refuse(self, dialog: Any) -> None:
        self.said.append(f"dialog: {dialog.message}")
        dialog.dismiss()
