"""Hands for tests: short sample streams with a grasp in them."""

from teachpath.records import Sample, Vector

OPEN_HAND, CLOSED_HAND = (0.1,) * 22, (0.9,) * 22
PERIOD_NS = 20_000_000
START_NS = 1_700_000_000_000_000_000


def sample(sequence: int, position: Vector, flexions: tuple[float, ...] = OPEN_HAND, **changes: object) -> Sample:
    stamp = START_NS + sequence * PERIOD_NS
    values: dict[str, object] = {
        "tracker": "glove",
        "sequence": sequence,
        "device_ns": stamp,
        "receive_ns": stamp + 1_000_000,
        "position": position,
        "orientation": (1.0, 0.0, 0.0, 0.0),
        "flexions": flexions,
        "tracked": True,
    }
    return Sample(**{**values, **changes})  # type: ignore[arg-type]


def demonstration(first: int = 1, *, transport: int = 50, at: Vector = (0.5, 0.0, 0.5)) -> list[Sample]:
    """Reach from 0.3 m beside the object, carry it 0.4 m along x, return and rest."""
    x, y, z = at
    stream: list[tuple[Vector, tuple[float, ...]]] = []
    stream += [((x, y + 0.3 * (1 - i / 20), z), OPEN_HAND) for i in range(20)]
    stream += [((x + 0.4 * i / (transport - 1), y, z), CLOSED_HAND) for i in range(transport)]
    stream += [((x + 0.4 - 0.4 * i / 20, y + 0.3 * i / 20, z), OPEN_HAND) for i in range(20)]
    stream += [((x, y + 0.3, z), OPEN_HAND)] * 20
    return [sample(first + i, position, flexions) for i, (position, flexions) in enumerate(stream)]
