"""When messages of a topic are from: the time of exposure in their headers, or that of receipt where they have none."""

from collections.abc import Sequence
from typing import NamedTuple

from elbowroom.errors import BagError
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.storage import Stored


class Stamped(NamedTuple):
    """A message and its time.

    Args:
        stamp_ns: [ns].
        stored: the message.
    """

    stamp_ns: int
    stored: Stored


class Times(NamedTuple):
    """The messages of a topic by rising time.

    Args:
        messages: with their times; two may have the same.
        by_header: whether these are times of exposure; otherwise, of receipt.
        notes: what was odd.
    """

    messages: Sequence[Stamped]
    by_header: bool
    notes: Sequence[str]


def stamped(bag: Bag, topic: str) -> Times:
    """When the messages of a topic are from.

    Where no header of the topic has a stamp, the time of receipt is taken, and said. Where only some have none, these
    messages are left out: they are from nobody knows when.

    Args:
        bag: opened.
        topic: whose messages begin with a header.

    Raises:
        BagError: there is no such topic, or a message without a header.
    """
    found, none, broken = [], [], []
    for stored in bag.messages(topic):
        try:
            stamp = bag.stamp_ns(stored)
        except BagError:
            broken.append(stored)
            continue
        if stamp > 0:
            found.append(Stamped(stamp, stored))
        else:
            none.append(stored)
    notes = []
    if broken:
        notes.append(f"{topic}: {len(broken)} messages are damaged and left out")
    if none and found:
        notes.append(f"{topic}: {len(none)} messages without a stamp are left out")
    if none and not found:
        notes.append(
            f"{topic}: its headers have no stamp, so times are those of receipt: ages are too small by what it took "
            "to get there, and images that met on the way may be of different times"
        )
        found = [Stamped(stored.received_ns, stored) for stored in none]
        return Times(sorted(found, key=_time), False, notes)
    return Times(sorted(found, key=_time), True, notes)


def _time(message: Stamped) -> int:
    return message.stamp_ns
