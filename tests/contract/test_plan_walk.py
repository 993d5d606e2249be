"""`plan` reads as a pipeline: who follows it from call to call turns few pages back."""

from pathlib import Path

from tests.contract.call_walk import Package, revisits

MOTION = Path(__file__).parents[2] / "service" / "teachpath" / "motion"
MAX_REVISITS = 5


def test_whoever_reads_plan_turns_few_pages_back() -> None:
    """The files are those of the room that `plan` lies in: what lower floors do is known by its name."""
    package = Package.read(MOTION, "teachpath.motion")
    entered = [module for module, _ in package.walk(("teachpath.motion.planning.plan", "plan"))]
    planning = [module for module in entered if module.startswith("teachpath.motion.planning.")]
    assert len(set(planning)) > 5
    assert len(revisits(planning)) <= MAX_REVISITS, revisits(planning)


def test_the_walk_enters_each_function_once_where_it_is_first_mentioned(tmp_path: Path) -> None:
    (tmp_path / "story.py").write_text(
        "from pkg.first import one, Thing\nfrom pkg.second import two\n"
        "def tell(value: two) -> None:\n    end(two(one(value)))\n    Thing().only_here()\n    one(two(2))\n"
        "def end(value: int) -> int:\n    return value\n"
    )
    (tmp_path / "first.py").write_text(
        "def one(value: int) -> int:\n    return value\n"
        "class Thing:\n    def only_here(self) -> None:\n        helper()\n"
        "def helper() -> None:\n    pass\n"
    )
    (tmp_path / "second.py").write_text("def two(value: int) -> int:\n    return value\n")
    walked = list(Package.read(tmp_path, "pkg").walk(("pkg.story", "tell")))
    assert walked == [
        ("pkg.story", "tell"),
        ("pkg.story", "end"),
        ("pkg.second", "two"),
        ("pkg.first", "one"),
        ("pkg.first", "Thing.only_here"),
        ("pkg.first", "helper"),
    ]


def test_a_file_counts_again_when_it_was_left() -> None:
    assert revisits(["a", "a", "b", "a", "a", "c", "b"]) == ["a", "b"]
    assert revisits(["a", "b", "c"]) == []
