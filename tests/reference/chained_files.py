"""Chained files of a few steps, and what they hold."""

from pathlib import Path

from elbowroom.wire.mcap_writer import Attached, McapWriter, Told
from elbowroom.wire.ros_messages import joint_state_message, text_message
from elbowroom.wire.ros_schemas import JOINT_STATE, STRING

ATTACHED = (Attached("site.yaml", "application/yaml", b"name: a room\n"),)


def messages_of(number: int) -> list[Told]:
    """Of a step."""
    joints = joint_state_message(number, {"slide": number / 3})
    return [
        Told("/joint_states", JOINT_STATE, joints, number),
        Told("/words", STRING, text_message(f"step {number}" * (1 + number)), number),
    ]


def write_steps(path: Path, many: int, ends: bool = True) -> bytes:
    """A file of so many steps; its bytes."""
    writer = McapWriter(path, ATTACHED)
    for number in range(many):
        writer.step(messages_of(number), number * 1000)
    writer.end() if ends else writer.drop()
    return path.read_bytes()
