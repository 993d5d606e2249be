"""The messages on the bus: `make proto` writes their Python modules after a wanted change of the .proto files.

`python -m tests.contract.messages promise` writes what a message of this version is, which the next one has to keep.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from grpc_tools import protoc

PACKAGE = Path(__file__).parents[2] / "proto" / "teachpath_proto"
SOURCES = "teachpath/v1"  # where the folders of protobuf's package are, seen from ours
FILES = sorted((PACKAGE / SOURCES).glob("*.proto"))
PROMISE = Path(__file__).with_name("messages_v1.binpb")


def generate(folder: Path) -> None:
    """Write the modules of all messages, and their stubs, into a folder."""
    with TemporaryDirectory() as made:
        _compile(f"--python_out={made}", f"--pyi_out={made}")
        for file in (Path(made) / SOURCES).iterdir():
            # A message is found again (by pickle) in our package; what it is made of, protoc leaves open in its stub.
            text = file.read_text().replace(f"'{SOURCES.replace('/', '.')}.", f"'{PACKAGE.name}.")
            (folder / file.name).write_text(text.replace("_Mapping]", "_Mapping[str, object]]"))


def write_descriptors(file: Path) -> None:
    """Write what the messages are, as protobuf's `FileDescriptorSet`."""
    _compile(f"--descriptor_set_out={file}")


def _compile(*options: str) -> None:
    names = [file.relative_to(PACKAGE).as_posix() for file in FILES]
    if protoc.main(["protoc", f"-I{PACKAGE}", *options, *names]):
        raise SystemExit("protoc found the faults above")


if __name__ == "__main__":
    if sys.argv[1:] == ["promise"]:
        write_descriptors(PROMISE)
    else:
        generate(PACKAGE)
