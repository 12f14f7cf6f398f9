"""The machine: its links and joints, where they are, which voxels they cover, which pixels they explain."""

from elbowroom.machine.body import body_words, default_growth
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.machine.contact import Contact
from elbowroom.machine.explain import Explained, explain_frames
from elbowroom.machine.joint import Joint, Mimic
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine
from elbowroom.machine.part import Part
from elbowroom.machine.samples import BodySamples, body_samples
from elbowroom.machine.stand import Stand
from elbowroom.machine.zone import Zone

__all__ = [
    "BodySamples",
    "Contact",
    "Explained",
    "Joint",
    "Link",
    "Machine",
    "Mimic",
    "Part",
    "Stand",
    "Zone",
    "body_samples",
    "body_words",
    "ceiling_c_arm",
    "default_growth",
    "explain_frames",
]
