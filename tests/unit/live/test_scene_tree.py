"""The tree of the view: what a page that does not listen costs, and what one that comes late is told."""

from teachpath.live.preview.scene_tree import MAX_UNACKNOWLEDGED, SceneTree
from tests.unit.live.pages import ignore, split


def test_replays_parents_first_and_one_value_a_property() -> None:
    tree = SceneTree()
    tree.set_object("/a/b", b"child")
    tree.set_object("/a", b"parent")
    for i in range(1000):
        tree.set_property("/a", "visible", b"%d" % i)
        tree.set_transform("/a/b", b"t%d" % i)
    sent = split(tree.connect(ignore).pop())
    assert sent.index(b"parent") < sent.index(b"child")
    assert sorted(sent) == sorted([b"parent", b"child", b"999", b"t999"])


def test_a_page_that_does_not_acknowledge_gets_the_newest_later_and_nothing_grows() -> None:
    tree = SceneTree()
    stalled, lively = tree.connect(ignore), tree.connect(ignore)
    told = 0
    for i in range(5000):
        tree.set_transform("/arm", b"t%d" % i)
        tree.set_object("/trail", b"o%d" % i)
        stalled.pop()
        told += len(split(lively.pop()))
        lively.acknowledge()
    assert told == 10_000  # the stalled one disturbs nobody
    assert stalled.pending == 2
    stalled.acknowledge(MAX_UNACKNOWLEDGED)
    assert split(stalled.pop()) == [b"o4999", b"t4999"]


def test_credit_is_given_back_batch_by_batch() -> None:
    tree = SceneTree()
    viewer = tree.connect(ignore)
    sent = 0
    for i in range(10):
        tree.set_transform("/arm", b"%d" % i)
        sent += viewer.pop() is not None
    assert sent == MAX_UNACKNOWLEDGED
    viewer.acknowledge()
    assert split(viewer.pop()) == [b"9"]
    assert viewer.pop() is None


def test_delete_takes_the_subtree_and_all_that_was_still_to_be_sent_about_it() -> None:
    tree = SceneTree()
    viewer = tree.connect(ignore)
    tree.set_object("/paths/a", b"a")
    tree.set_transform("/paths/a", b"ta")
    tree.set_object("/pathsandmore", b"kept")
    tree.delete("/paths", b"gone")
    assert split(viewer.pop()) == [b"kept", b"gone"]
    assert tree.paths() == ["/pathsandmore"]
    assert split(tree.connect(ignore).pop()) == [b"kept"]


def test_what_is_shown_after_a_delete_comes_after_it() -> None:
    tree = SceneTree()
    viewer = tree.connect(ignore)
    tree.set_object("/paths/a", b"old")
    tree.delete("/paths", b"gone")
    tree.set_object("/paths/a", b"new")
    assert split(viewer.pop()) == [b"gone", b"new"]


def test_a_detached_page_hears_no_more() -> None:
    tree = SceneTree()
    woken: list[int] = []
    viewer = tree.connect(lambda: woken.append(1))
    tree.set_object("/a", b"a")
    tree.disconnect(viewer)
    tree.set_object("/b", b"b")
    assert len(woken) == 1
    assert split(viewer.pop()) == [b"a"]


def test_the_same_transform_twice_is_sent_once() -> None:
    tree = SceneTree()
    viewer = tree.connect(ignore)
    tree.set_transform("/arm", b"t")
    viewer.pop()
    tree.set_transform("/arm", b"t")
    assert viewer.pop() is None
