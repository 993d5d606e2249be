"""Which values one schema of a description has beyond those of another."""

from collections.abc import Iterator
from typing import Any

Schema = dict[str, Any]
LOWER_BOUNDS = ("minimum", "exclusiveMinimum", "minLength", "minItems")
UPPER_BOUNDS = ("maximum", "exclusiveMaximum", "maxLength", "maxItems")


class Values:
    """Compares the values that two descriptions allow in one place.

    Args:
        wide: the description that has to allow all that `narrow` does.
        narrow: the other one.
        are_answers: a field that `wide` does not know is no fault then, and each that it has must be there.
    """

    def __init__(self, *, wide: Schema, narrow: Schema, are_answers: bool) -> None:
        self._wide, self._narrow, self._are_answers = wide, narrow, are_answers
        self._compared: dict[tuple[str, str], list[str]] = {}

    def faults(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        """Return what `narrow` allows and `wide` does not; of two models with the place where they come first."""
        pair = (wide.get("$ref", ""), narrow.get("$ref", ""))
        if not all(pair):
            return self._compare(place, wide, narrow)
        if pair not in self._compared:
            self._compared[pair] = []  # for a model within itself
            self._compared[pair] = list(self._compare(place, wide, narrow))
        return iter(self._compared[pair])

    def _compare(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        if not self._are_answers and narrow.get("default") != wide.get("default"):
            yield f"{place} left out was {narrow.get('default')} and is {wide.get('default')}"
        known = alternatives(self._wide, wide)
        for each in alternatives(self._narrow, narrow):
            best = min((list(self._beyond(place, other, each)) for other in known), key=len)
            yield from best

    def _beyond(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        kinds = (narrow.get("type"), wide.get("type"))
        if wide and kinds[0] != kinds[1] and kinds != ("integer", "number"):
            yield f"{place} may be {kinds[0] or 'anything'}, where it is {kinds[1]}"
            return
        yield from self._words(place, wide, narrow)
        yield from self._limits(place, wide, narrow)
        yield from self._items(place, wide, narrow)
        if narrow.get("type") == "object":
            yield from self._fields(place, wide, narrow)

    def _words(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        known, said = words(wide), words(narrow)
        if known is None:
            return
        if said is None:
            yield f"{place} may be any word, where it is one of {sorted(map(str, known))}"
        elif new := said - known:
            yield f"{place} may be {sorted(map(str, new))}"

    def _limits(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        for name in (*LOWER_BOUNDS, *UPPER_BOUNDS):
            if name in wide:
                sign = 1 if name in LOWER_BOUNDS else -1
                if name not in narrow or sign * narrow[name] < sign * wide[name]:
                    yield f"{place}: {name} is {wide[name]}, and was {narrow.get(name, 'none')}"
        for name in ("pattern", "format"):
            if name in wide and narrow.get(name) != wide[name]:
                yield f"{place}: {name} is {wide[name]}, and was {narrow.get(name, 'none')}"

    def _items(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        if "items" in wide:
            yield from self.faults(f"{place}[]", wide["items"], narrow.get("items", {}))
        for number, (one, other) in enumerate(
            zip(wide.get("prefixItems", []), narrow.get("prefixItems", []), strict=False)
        ):
            yield from self.faults(f"{place}[{number}]", one, other)

    def _fields(self, place: str, wide: Schema, narrow: Schema) -> Iterator[str]:
        here, there = narrow.get("properties", {}), wide.get("properties", {})
        for name in wide.get("required", []):
            if name not in narrow.get("required", []):
                yield f"{place}.{name} may be left out, where it must be there"
        if self._are_answers:
            yield from (f"{place}.{name} is gone" for name in there.keys() - here.keys())
        elif wide.get("additionalProperties") is False:
            yield from (f"{place}.{name} is not known any more" for name in here.keys() - there.keys())
        for name in here.keys() & there.keys():
            yield from self.faults(f"{place}.{name}", there[name], here[name])
        inner = wide.get("additionalProperties")
        if isinstance(inner, dict):
            others = narrow.get("additionalProperties", {})
            yield from self.faults(f"{place}.*", inner, others if isinstance(others, dict) else {})


def alternatives(description: Schema, schema: Schema) -> list[Schema]:
    """Return the schemas of which a value has one, without references."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return alternatives(description, description["components"]["schemas"][name])
    if "anyOf" in schema:
        return [each for inner in schema["anyOf"] for each in alternatives(description, inner)]
    return [schema]


def words(schema: Schema) -> set[Any] | None:
    """Return the words that a value is one of; None: it may be others, too."""
    if "const" in schema:
        return {schema["const"]}
    return set(schema["enum"]) if "enum" in schema else None
