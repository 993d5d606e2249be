import teachpath_client


def test_the_menu_is_complete() -> None:
    for name in teachpath_client.__all__:
        assert getattr(teachpath_client, name).__doc__
