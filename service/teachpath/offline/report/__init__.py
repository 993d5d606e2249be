"""The review package: one HTML file about a learning run that opens anywhere, without a service."""

from teachpath.offline.report.content import Review, review_of
from teachpath.offline.report.page import write

__all__ = ["Review", "review_of", "write"]
