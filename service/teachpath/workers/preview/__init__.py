"""The preview: draws scene, demonstrations, learned paths, hand and arm for every connected page.

Names in its tree, on which pages and tests may rely: `/scene/<name>` (table and obstacles), `/object` (the carried
one), `/robot/link<i>/<part>` (blanks as `-`), `/demonstrations/<id>`, `/paths/<id>`, `/hand/<tracker>/{marker,trail}`.
"""

from teachpath.workers.preview.commands import WAYS, viewer_files
from teachpath.workers.preview.tree import Page
from teachpath.workers.preview.worker import Preview, PreviewSettings

__all__ = ["WAYS", "Page", "Preview", "PreviewSettings", "viewer_files"]
