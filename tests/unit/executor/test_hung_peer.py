"""Whoever does not read keeps no control loop waiting: all that it publishes is dropped where the way out is full."""

from teachpath.io.bus_delivery import WAITS, Delivery
from teachpath.io.memory_bus import MemoryBus
from teachpath.records import Plan
from tests.unit.executor.executors import KEYS, Bench


class WatchedBus(MemoryBus):
    """Notes how what is published would be delivered on a line that is full."""

    def __init__(self) -> None:
        super().__init__()
        self.deliveries: dict[str, set[Delivery]] = {}

    def publish(self, key: str, payload: bytes, *, source: str | None = None, delivery: Delivery = WAITS) -> None:
        self.deliveries.setdefault(key, set()).add(delivery)
        super().publish(key, payload, source=source, delivery=delivery)


def test_a_control_loop_waits_for_nobody_and_fills_no_way_out_of_the_journal(middle: Plan) -> None:
    bus = WatchedBus()
    bench = Bench(bus=bus)
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.setpoints
    assert bench.statuses
    assert bench.journal
    assert bus.deliveries[KEYS.setpoint("puma560")] == {Delivery.DROPS}
    assert bus.deliveries[KEYS.executor_status] == {Delivery.DROPS}
    assert bus.deliveries[KEYS.executor_journal] == {Delivery.DROPS_LAST}
