"""The tree of the view: what a page that does not listen costs, and what one that comes late is told."""

from teachpath.live.preview.tree import CREDIT, SceneTree
from tests.unit.live.pages import ignore, split


def test_replays_parents_first_and_one_value_a_property() -> None:
    tree = SceneTree()
    tree.put_object("/a/b", b"child")
    tree.put_object("/a", b"parent")
    for i in range(1000):
        tree.put_property("/a", "visible", b"%d" % i)
        tree.put_transform("/a/b", b"t%d" % i)
    sent = split(tree.attach(ignore).take())
    assert sent.index(b"parent") < sent.index(b"child")
    assert sorted(sent) == sorted([b"parent", b"child", b"999", b"t999"])


def test_a_page_that_does_not_acknowledge_gets_the_newest_later_and_nothing_grows() -> None:
    tree = SceneTree()
    stalled, lively = tree.attach(ignore), tree.attach(ignore)
    told = 0
    for i in range(5000):
        tree.put_transform("/arm", b"t%d" % i)
        tree.put_object("/trail", b"o%d" % i)
        stalled.take()
        told += len(split(lively.take()))
        lively.acknowledge()
    assert told == 10_000  # the stalled one disturbs nobody
    assert stalled.pending == 2
    stalled.acknowledge(CREDIT)
    assert split(stalled.take()) == [b"o4999", b"t4999"]


def test_credit_is_given_back_batch_by_batch() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    sent = 0
    for i in range(10):
        tree.put_transform("/arm", b"%d" % i)
        sent += page.take() is not None
    assert sent == CREDIT
    page.acknowledge()
    assert split(page.take()) == [b"9"]
    assert page.take() is None


def test_delete_takes_the_subtree_and_all_that_was_still_to_be_sent_about_it() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_object("/paths/a", b"a")
    tree.put_transform("/paths/a", b"ta")
    tree.put_object("/pathsandmore", b"kept")
    tree.delete("/paths", b"gone")
    assert split(page.take()) == [b"kept", b"gone"]
    assert tree.paths() == ["/pathsandmore"]
    assert split(tree.attach(ignore).take()) == [b"kept"]


def test_what_is_shown_after_a_delete_comes_after_it() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_object("/paths/a", b"old")
    tree.delete("/paths", b"gone")
    tree.put_object("/paths/a", b"new")
    assert split(page.take()) == [b"gone", b"new"]


def test_a_detached_page_hears_no_more() -> None:
    tree = SceneTree()
    woken: list[int] = []
    page = tree.attach(lambda: woken.append(1))
    tree.put_object("/a", b"a")
    tree.detach(page)
    tree.put_object("/b", b"b")
    assert len(woken) == 1
    assert split(page.take()) == [b"a"]


def test_the_same_transform_twice_is_sent_once() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_transform("/arm", b"t")
    page.take()
    tree.put_transform("/arm", b"t")
    assert page.take() is None
