"""A program that was made of the messages of this version goes on: its fields keep number, name and type."""

from collections.abc import Iterator

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from teachpath_proto import job_pb2, motion_pb2, tracker_pb2
from tests.contract import messages

PROMISED_FILES = FileDescriptorSet.FromString(messages.PROMISE.read_bytes())


def broken(promised: FileDescriptorSet, present: FileDescriptorSet) -> Iterator[str]:
    """Yield what is gone or has changed; what was added breaks nothing."""
    now = dict(declared(present))
    for place, kind in declared(promised):
        if place not in now:
            yield f"{place} ({kind}) is gone"
        elif now[place] != kind:
            yield f"{place} was {kind} and is {now[place]}"


def declared(files: FileDescriptorSet) -> Iterator[tuple[str, str]]:
    """Yield the places of all messages, fields and words of enumerations, by number, with what is there."""
    for file in files.file:
        for message in file.message_type:
            yield from in_message(f"{file.package}.{message.name}", message)
        for enumeration in file.enum_type:
            yield from in_enumeration(f"{file.package}.{enumeration.name}", enumeration)


def in_message(place: str, message: DescriptorProto) -> Iterator[tuple[str, str]]:
    yield place, "message"
    for field in message.field:
        optional = " optional" if field.proto3_optional else ""
        kind = field.type_name or FieldDescriptorProto.Type.Name(field.type)
        label = FieldDescriptorProto.Label.Name(field.label)
        yield f"{place} {field.number}", f"{field.name}, {kind} {label}{optional}"
    for inner in message.nested_type:
        yield from in_message(f"{place}.{inner.name}", inner)
    for enumeration in message.enum_type:
        yield from in_enumeration(f"{place}.{enumeration.name}", enumeration)


def in_enumeration(place: str, enumeration: EnumDescriptorProto) -> Iterator[tuple[str, str]]:
    yield place, "enumeration"
    yield from ((f"{place} {word.number}", word.name) for word in enumeration.value)


def present() -> FileDescriptorSet:
    files = FileDescriptorSet()
    for module in (job_pb2, motion_pb2, tracker_pb2):
        file = FileDescriptorProto()
        module.DESCRIPTOR.CopyToProto(file)
        files.file.append(file)
    return files


def test_messages_keep_what_this_version_promised() -> None:
    assert list(broken(PROMISED_FILES, present())) == []


def test_what_breaks_a_promise_is_found() -> None:
    changed = present()
    fields = {message.name: message.field for file in changed.file for message in file.message_type}
    (progress,) = [field for field in fields["JobProgress"] if field.name == "fraction"]
    progress.type = progress.TYPE_FLOAT
    fields["Vector3"].pop(2)
    fields["Vector3"].add(name="w", number=4, type=progress.TYPE_DOUBLE)
    double = "TYPE_DOUBLE LABEL_OPTIONAL"
    assert list(broken(PROMISED_FILES, changed)) == [
        f"teachpath.v1.JobProgress 4 was fraction, {double} and is fraction, {double.replace('DOUBLE', 'FLOAT')}",
        f"teachpath.v1.Vector3 3 (z, {double}) is gone",
    ]
