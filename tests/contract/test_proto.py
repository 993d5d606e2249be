"""The generated messages are those of the .proto files."""

from pathlib import Path

from grpc_tools import protoc

PROTO = Path(__file__).parents[2] / "proto"


def test_generated_messages_are_up_to_date(tmp_path: Path) -> None:
    sources = sorted(p.relative_to(PROTO).as_posix() for p in PROTO.glob("teachpath_proto/*.proto"))
    code = protoc.main(["protoc", f"-I{PROTO}", f"--python_out={tmp_path}", f"--pyi_out={tmp_path}", *sources])
    assert code == 0
    fresh = {p.relative_to(tmp_path).as_posix(): p.read_text() for p in tmp_path.rglob("*.py*")}
    kept = {p.relative_to(PROTO).as_posix(): p.read_text() for p in PROTO.glob("teachpath_proto/*_pb2.py*")}
    assert len(fresh) == 2 * len(sources)
    assert fresh == kept, "run: make proto"
