"""Files that expand are refused before their memory is taken: one small file of each format that would be huge."""

import io
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk, Header

# Far above what a refusal takes, which is 0.1 s and 20 MB; an import without limits takes 5 s and 2 GB.
MAX_PROCESSOR_TIME = 1.0  # [s]
MAX_MEMORY = 100e6  # [bytes] more than before the import
# Loads what an import needs once; every import is then a process of its own, forked from that.
IMPORTS = """
import json, os, sys, time
from pathlib import Path
from teachpath.errors import TeachpathError
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.file_samples import Source
from teachpath.offline.importing import import_file
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Scene

def peak():
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024

def tried(data, file, kind):
    store = Store(StoreSettings(data_dir=data))
    content, refusal = Path(file).read_bytes(), ""
    memory, start = peak(), time.process_time()
    try:
        import_file(store, RecordingSettings(), Source("file", content, kind), task="wipe", scene=Scene("empty"),
                    calibration=Calibration("identity"), limits=ImportSettings())
    except TeachpathError as error:
        refusal = str(error)
    return [refusal, time.process_time() - start, peak() - memory, len(store.tasks())]

for line in sys.stdin:
    child = os.fork()
    if child == 0:
        print(json.dumps(tried(*json.loads(line))), flush=True)
        os._exit(0)
    if os.waitpid(child, 0)[1] != 0:
        print(json.dumps("it died"), flush=True)
"""


@pytest.fixture(scope="module")
def importer() -> Iterator[subprocess.Popen[str]]:
    """A process that imports: takes folder, file and kind, and says refusal, time [s], memory [bytes] and tasks."""
    command = [sys.executable, "-c", IMPORTS]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        yield process
        assert process.stdin is not None
        process.stdin.close()


def mcap(compression: str, data: bytes, stated: int, chunks: int = 1) -> bytes:
    builder = RecordBuilder()
    Header(profile="", library="").write(builder)
    for _ in range(chunks):
        Chunk(compression, data, 0, 0, 0, stated).write(builder)
    return b"\x89MCAP0\r\n" + builder.end()


def zeros(size: int, compression: str) -> bytes:
    if compression == "lz4":
        return bytes(lz4.frame.compress(bytes(size)))
    stream = io.BytesIO()
    with zstandard.ZstdCompressor().stream_writer(stream, size=size, closefd=False) as writer:
        for _ in range(size // 2**20):
            writer.write(bytes(2**20))
    return stream.getvalue()


def long_csv(rows: int) -> bytes:
    return b"t,x,y,z\n" + b"0,0,0,0\n" * rows


def npy(shape: tuple[int, ...], dtype: str) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": dtype, "fortran_order": False, "shape": shape})
    return stream.getvalue()


FULL_SIZE = 16 * 2**20
BOMBS: dict[str, tuple[str, Callable[[], bytes], str]] = {
    "a chunk that says that it expands to 1 GiB": (
        "mcap",
        lambda: mcap("zstd", zeros(2**30, "zstd"), 2**30),
        "its chunks expand to 1073741824 bytes or more, limit 268435456",
    ),
    "a chunk of 64 MiB": (
        "mcap",
        lambda: mcap("zstd", zeros(2**26, "zstd"), 2**26),
        "expands to 67108864, limit 16777216",
    ),
    "a chunk that lies": (
        "mcap",
        lambda: mcap("zstd", zeros(2**30, "zstd"), 1000),
        "states 1000 bytes expands to more",
    ),
    "a chunk of lz4 that lies": (
        "mcap",
        lambda: mcap("lz4", zeros(2**26, "lz4"), 1000),
        "states 1000 bytes expands to more",
    ),
    "many chunks": (
        "mcap",
        lambda: mcap(
            "zstd",
            zstandard.compress(b"\x80" + (FULL_SIZE - 9).to_bytes(8, "little") + bytes(FULL_SIZE - 9)),
            FULL_SIZE,
            40,
        ),
        "its chunks expand to 285212672 bytes or more, limit 268435456",
    ),
    "lines": ("csv", lambda: bytes(8_000_000).replace(b"\0", b"\n"), "over 501000 lines"),
    "one line": ("csv", lambda: b"t,x,y,z\n" + b"1," * 4_000_000, "line 2: over 1000000 characters"),
    "rows": ("csv", lambda: long_csv(520_000), "over 501000 lines"),
    "a deep statement": ("csv", lambda: b"# teachpath " + b"[" * 900_000 + b"\n", "not the samples of a demonstration"),
    "a long statement": ("csv", lambda: b"# teachpath " + b"[" * 8_000_000, "line 1: over 1000000 characters"),
    "an array of samples": ("npy", lambda: npy((700_000, 7), "<f2") + bytes(9_800_000), "700000 samples, limit 500000"),
    "an array of motions": ("npy", lambda: npy((10_000, 20, 4), "<f4"), "10000 motions, limit 1000"),
    "an array without content": ("npy", lambda: npy((100_000, 8), "<f8"), "is not what 0 bytes hold"),
}


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the system does not tell the peak of memory")
@pytest.mark.parametrize(("kind", "content", "sentence"), BOMBS.values(), ids=BOMBS)
def test_a_file_that_expands_is_refused_before_it_takes_memory(
    importer: subprocess.Popen[str], tmp_path: Path, kind: str, content: Callable[[], bytes], sentence: str
) -> None:
    assert importer.stdin is not None
    assert importer.stdout is not None
    file = tmp_path / "file"
    file.write_bytes(content())
    importer.stdin.write(json.dumps([str(tmp_path / "data"), str(file), kind]) + "\n")
    importer.stdin.flush()
    refusal, processor_time, memory, tasks = json.loads(importer.stdout.readline())
    assert sentence in refusal
    assert tasks == 0
    assert memory < MAX_MEMORY
    assert processor_time < MAX_PROCESSOR_TIME
