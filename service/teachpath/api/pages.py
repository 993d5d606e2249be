"""Lists over REST: `limit` and `after` choose a page, the header Link names the next one."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Query, Request, Response

from teachpath.api.answers import json_response
from teachpath.io.store.pages import DEFAULT_LIMIT, MAX_CURSOR_LENGTH, MAX_LIMIT, Page, PageRequest

ABOUT_AFTER = (
    "cursor of a page, as the header Link of the page before has it, rel=next; empty: the first page. A page without "
    "that header is the last one"
)
After = Annotated[str, Query(max_length=MAX_CURSOR_LENGTH, description=ABOUT_AFTER)]
Limit = Annotated[int, Query(ge=1, le=MAX_LIMIT, description="entries of a page, at most")]


class Paging:
    """The page of a list that a request wants, and the answer with that page."""

    def __init__(self, request: Request, after: After = "", limit: Limit = DEFAULT_LIMIT) -> None:
        self.wanted: PageRequest = PageRequest(limit, after)
        self._url = request.url

    def answer(self, page: Page[Any]) -> Response:
        """Return a page as JSON; its header Link names the page after it, if there is one."""
        following = self._url.include_query_params(after=page.next, limit=self.wanted.limit)
        link = f'<{following.path}?{following.query}>; rel="next"'
        return json_response(page.entries, headers={"Link": link} if page.next else None)


WantedPage = Annotated[Paging, Depends()]
