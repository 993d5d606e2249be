from teachpath.recording.message_counter import MAX_KINDS, MessageCounter


def test_reasons_that_differ_in_numbers_are_one_kind_and_hide_no_other() -> None:
    refusals = MessageCounter("samples were refused for other reasons")
    for i in range(1000):
        refusals.add(f"sample {i} of glove: position ({i / 7}, nan, -inf) is not finite")
    refusals.add("a sample of 5000 bytes is over the limit of 4096")
    many, one = refusals.messages()
    assert many == "sample 0 of glove: position (0.0, nan, -inf) is not finite (and 999 more like it)"
    assert one == "a sample of 5000 bytes is over the limit of 4096"


def test_a_flood_of_kinds_is_counted_and_not_remembered() -> None:
    refusals = MessageCounter("samples were refused for other reasons")
    for i in range(300):
        refusals.add("fault " + "x" * i)
    said = refusals.messages()
    assert len(said) == MAX_KINDS + 1
    assert said[-1] == f"samples were refused for other reasons (and {300 - MAX_KINDS - 1} more like it)"
