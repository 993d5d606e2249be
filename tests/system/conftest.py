from collections.abc import Iterator

import pytest

from tests.system.processes import Service


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One running service for the tests of a module; each uses tasks and trackers of its own."""
    with Service(tmp_path_factory.mktemp("station") / "data") as service:
        yield service
