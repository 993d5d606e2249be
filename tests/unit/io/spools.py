"""The spool of a data folder, by a clock of its own."""

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.spool import LINGER, Spool
from teachpath.io.store.store import Store


def upload(settings: StoreSettings, passes: int = 3) -> None:
    """Upload the recordings of a data folder; after the first pass their files are still there."""
    store, times = Store(settings), [0.0]
    rows = (store.checks.places, store.demonstration, store.change_demonstration)
    spool = Spool(store.recordings, *rows, clock=lambda: times[-1])
    for _ in range(passes):
        spool.work()
        times.append(times[-1] + 2.0 * LINGER)
    store.close()
