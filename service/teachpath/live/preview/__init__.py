"""The preview: draws what moves, arm, object and hands, for every connected page.

Names in its tree, on which pages and tests may rely: `/object` (the carried one), `/robot/link<i>/<part>` (blanks as
`-`), `/hand/<tracker>/{marker,trail}`. Everything else a page draws by itself, for the task that it looks at.
"""

from teachpath.live.preview.asset_paths import viewer_files, web_files
from teachpath.live.preview.commands import CLUSTER_COLORS
from teachpath.live.preview.preview import Preview, PreviewSettings
from teachpath.live.preview.scene_tree import Viewer

__all__ = ["CLUSTER_COLORS", "Preview", "PreviewSettings", "Viewer", "viewer_files", "web_files"]
