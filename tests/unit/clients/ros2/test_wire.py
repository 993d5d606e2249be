import pytest

from teachpath_client.ros2.wire import Attachment, Topic, read_token, token
from tests.unit.clients.ros2 import golden

# The keys of rmw_zenoh's design document.
STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
CHATTER = Topic("/chatter", "std_msgs/msg/String", STRING)
ZID = "aac3178e146ba6f1fc6e6a4085e77f21"
TALKER = f"@ros2_lv/2/{ZID}/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{STRING}"


def test_a_topic_lies_on_domain_name_type_and_hash() -> None:
    assert CHATTER.key(2) == f"2/chatter/std_msgs::msg::dds_::String_/{STRING}"
    deep = Topic("/robot1/vive/pose", "geometry_msgs/msg/PoseStamped", "RIHS01_0")
    assert deep.key(0) == "0/robot1/vive/pose/geometry_msgs::msg::dds_::PoseStamped_/RIHS01_0"


def test_a_bridge_puts_it_on_its_name_alone() -> None:
    assert Topic("/robot1/pose", "geometry_msgs/msg/PoseStamped", bridged=True).key(7) == "robot1/pose"


def test_a_token_names_node_topic_type_and_quality_of_service() -> None:
    assert token("NN", 2, ZID, 0, "talker") == f"@ros2_lv/2/{ZID}/0/0/NN/%/%/talker"
    assert token("MP", 2, ZID, 10, "talker", CHATTER) == f"{TALKER}/::,10:,:,:,,"


def test_tokens_of_both_forms_are_read() -> None:
    assert read_token(f"{TALKER}/::,7:,:,:,,") == ("MP", CHATTER)
    bridged = Topic("/bot/pose", "geometry_msgs/msg/PoseStamped", bridged=True)
    assert read_token(f"@/{ZID}/@ros2_lv/MS/bot§pose/geometry_msgs§msg§PoseStamped/:1:0:0,10") == ("MS", bridged)
    for other in (f"@ros2_lv/2/{ZID}/0/0/NN/%/%/talker", f"@/{ZID}/@ros2_lv", "a/b", "", "/".join("x" * 13)):
        assert read_token(other) is None


@pytest.mark.parametrize("content", [golden.ATTACHMENT, golden.NAMED_ATTACHMENT])
def test_attachments_of_all_versions_are_read(content: bytes) -> None:
    assert Attachment.unpack(content) == Attachment(5, 7, bytes(range(16)))


def test_an_attachment_is_written_as_the_present_version_does() -> None:
    assert Attachment(5, 7, bytes(range(16))).pack() == golden.ATTACHMENT


def test_what_is_no_attachment_is_refused() -> None:
    wrong = golden.ATTACHMENT[:16] + b"\x11" + golden.ATTACHMENT[17:]
    for content in (*(golden.ATTACHMENT[:size] for size in range(33)), golden.ATTACHMENT + b"\0", wrong):
        with pytest.raises(ValueError, match="attachment"):
            Attachment.unpack(content)
