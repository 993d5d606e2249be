"""The review package: one HTML file about a learning run that opens anywhere, without a service."""

from teachpath.offline.report.package import write_package
from teachpath.offline.report.review import Review, review_of

__all__ = ["Review", "review_of", "write_package"]
