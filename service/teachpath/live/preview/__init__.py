"""The preview: draws arm, object and hands for every connected page as they move.

Names in its tree, on which pages and tests may rely: `/object` (the carried one), `/robot/link<i>/<part>` (blanks as
`-`), `/hand/<tracker>/{marker,trail}`. Everything else a page draws by itself, for the task that it shows.
"""
