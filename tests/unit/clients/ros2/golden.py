"""Messages of ROS 2 byte by byte, by hand after the layout of CDR (OMG: XCDR 1): no library wrote them.

Every number lies at a multiple of its size, counted from behind the first four bytes.
"""

import struct

STAMP_NS = 1_700_000_000_000_000_005

POSE_KEY = (
    "0/vive/pose/geometry_msgs::msg::dds_::PoseStamped_/"
    "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"
)
POSE = bytes.fromhex(
    "00010000"  # CDR, little-endian, no options
    "00f15365 05000000"  # 1700000000 s, 5 ns
    "04000000 6d617000"  # "map", with its end
    "000000000000f83f 00000000000000c0 000000000000e03f"  # 1.5, -2, 0.5
    "000000000000f03f 0000000000000000 0000000000000000 0000000000000000"  # x, y, z, w = 1, 0, 0, 0
)
BIG_ENDIAN_POSE = bytes.fromhex(
    "00000000 6553f100 00000005 00000004 6d617000 3ff8000000000000 c000000000000000 3fe0000000000000"
    "3ff0000000000000 0000000000000000 0000000000000000 0000000000000000"
)
JOINTS = bytes.fromhex(
    "00010000"
    "00f15365 05000000"
    "01000000 00"  # no frame
    "000000"  # to a multiple of 4
    "02000000"  # two names
    "03000000 6a3100 00"
    "03000000 6a3200 00"
    "02000000"  # two positions, the first at byte 40
    "000000000000f83f 000000000000e03f"
    "00000000 00000000"  # neither speeds nor efforts
)
GRASP = bytes.fromhex("00010000 01")
OPEN_PREFIX = bytes.fromhex("00010000 00")

# number 5, stamp 7 ns, 16 bytes of the publisher
ATTACHMENT = bytes.fromhex("0500000000000000 0700000000000000 10 000102030405060708090a0b0c0d0e0f")
NAMED_ATTACHMENT = (
    b"\x0fsequence_number"
    + bytes.fromhex("0500000000000000")
    + b"\x10source_timestamp"
    + bytes.fromhex("0700000000000000")
    + b"\x0asource_gid"
    + bytes.fromhex("10 000102030405060708090a0b0c0d0e0f")
)


def posed(stamp_ns: int, position: tuple[float, float, float]) -> bytes:
    """Return `POSE` with another stamp and position."""
    head = POSE[:4] + struct.pack("<iI", *divmod(stamp_ns, 1_000_000_000))
    return head + POSE[12:20] + struct.pack("<3d", *position) + POSE[44:]


NO_MARKERS = bytes.fromhex(
    "00010000"
    "01000000"  # one marker
    "00000000 00000000 06000000 776f726c6400 0000"  # no stamp, frame "world", to a multiple of 4
    "01000000 00 000000"  # no namespace
    "00000000 04000000 03000000 00000000"  # id 0, LINE_STRIP, DELETEALL, to a multiple of 8
    "0000000000000000 0000000000000000 0000000000000000"  # position
    "0000000000000000 0000000000000000 0000000000000000 000000000000f03f"  # x, y, z, w = 0, 0, 0, 1
    "0000000000000000 0000000000000000 0000000000000000"  # scale
    "00000000 00000000 00000000 00000000"  # colour
    "00000000 00000000"  # lives for ever
    "00 000000 00000000 00000000"  # not locked to its frame; no points, no colours
    "01000000 00 000000"  # no texture
    "00000000 00000000 01000000 00 000000 01000000 00 000000 00000000"  # its image: no stamp, frame, format, bytes
    "00000000"  # nor its coordinates
    "01000000 00 000000 01000000 00 000000"  # no text, no mesh
    "01000000 00 000000 00000000"  # nor its file
    "00"
)


def report(sentence: str) -> bytes:
    """Return the DiagnosticArray of a refusal at `STAMP_NS`, of the arm "puma560", by teachpath's name for it."""

    def text(words: str) -> bytes:
        encoded = words.encode() + b"\0"
        return struct.pack("<I", len(encoded)) + encoded

    body = struct.pack("<iI", *divmod(STAMP_NS, 1_000_000_000)) + text("")
    body += bytes(-len(body) % 4) + struct.pack("<I", 1)  # one status
    body += b"\x02"  # ERROR
    for words in ("teachpath: execution by topic", sentence, "puma560"):
        body += bytes(-len(body) % 4) + text(words)
    return b"\0\1\0\0" + body + bytes(-len(body) % 4) + struct.pack("<I", 0)  # no values
