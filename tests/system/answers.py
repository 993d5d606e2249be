"""Answers of the service that come later than what a person does meanwhile."""

import re
from typing import Any

from tests.system.visits import Visit

Answer = tuple[Any, Any]  # a route of the browser, and what the service answered to it


class Late:
    """Keeps the answers to the questions that match until they are let go, in whatever order.

    Args:
        visit: the page that asks.
        pattern: regular expression of the resource under /api/v1/, from its beginning to its end, whatever its query.
        method: of the questions.
    """

    def __init__(self, visit: Visit, pattern: str, method: str = "GET") -> None:
        self._visit, self._method = visit, method
        self._over = False
        self.kept: list[Answer] = []
        visit.page.route(re.compile(rf".*/api/v1/{pattern}(\?.*)?$"), self._keep)

    def _keep(self, route: Any) -> None:
        if route.request.method != self._method or self._over:
            route.fallback()
            return
        answer = route.fetch()
        if self._over:  # since this was asked
            route.fulfill(response=answer)
        else:
            self.kept.append((route, answer))

    def wait(self, count: int = 1) -> None:
        """Wait until so many answers are kept."""
        self._visit.wait(lambda: len(self.kept) >= count)

    def let_go(self, index: int = 0, **instead: Any) -> None:
        """Give one answer, or another one instead of it, and wait until the page has had it."""
        route, answer = self.kept.pop(index)
        route.fulfill(**(instead or {"response": answer}))
        # what is asked after it is answered after it, and drawn
        self._visit.page.evaluate("fetch('/api/v1/station').then(() => new Promise(requestAnimationFrame))")

    def over(self) -> None:
        """Give all that is kept, and keep no more."""
        self._over = True
        while self.kept:
            self.let_go()
