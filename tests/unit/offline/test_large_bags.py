"""A bag of any size is read where it lies, and the share that was read is told; other files have a limit."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.io.readers.registry import LARGEST_FILE
from teachpath.offline.file_report import examine_upload
from teachpath.offline.import_job import UPLOAD, read_upload
from tests.unit.io.readers.bags import write_bag
from tests.unit.io.readers.test_bags import motion
from tests.unit.io.readers.test_formats import POSITIONS
from tests.unit.offline.batches import ORDER


def test_a_bag_that_is_too_large_for_memory_is_read_where_it_lies(tmp_path: Path) -> None:
    (tmp_path / UPLOAD).write_bytes(write_bag(tmp_path, "db3", motion("db3")))
    os.truncate(tmp_path / UPLOAD, LARGEST_FILE + 1)  # with what a database does not use
    order, shares = replace(ORDER, folder=tmp_path, name="large.db3"), list[float]()
    read = read_upload(order, progress=shares.append)
    assert np.allclose([sample.position for sample in read.motions[0]], POSITIONS)
    assert shares == [0.0]
    report = examine_upload(replace(order, marks=replace(order.marks, whole=True)))
    assert (report.refusal, report.format) == ("", "rosbag")


def test_what_has_to_be_in_memory_has_a_limit(tmp_path: Path) -> None:
    (tmp_path / UPLOAD).write_bytes(b"t,x,y,z\n")
    os.truncate(tmp_path / UPLOAD, LARGEST_FILE + 1)
    with pytest.raises(UnusableRecording, match=r"67108865 bytes are over the limit of 67108864; split the file"):
        read_upload(replace(ORDER, folder=tmp_path, name="large.csv"))
