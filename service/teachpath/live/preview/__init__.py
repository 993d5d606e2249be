"""The preview: draws what moves, arm, object and hands, for every connected page.

Names in its tree, on which pages and tests may rely: `/object` (the carried one), `/robot/link<i>/<part>` (blanks as
`-`), `/hand/<tracker>/{marker,trail}`. Everything else a page draws by itself, for the task that it looks at.
"""

from teachpath.live.preview.commands import WAYS
from teachpath.live.preview.files import viewer_files, web_files
from teachpath.live.preview.tree import Page
from teachpath.live.preview.worker import Preview, PreviewSettings

__all__ = ["WAYS", "Page", "Preview", "PreviewSettings", "viewer_files", "web_files"]
