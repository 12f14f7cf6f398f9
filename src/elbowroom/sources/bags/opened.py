"""Bags stay open between one use and the next: to look through one takes as long as to read it."""

from collections import OrderedDict
from pathlib import Path

from elbowroom.sources.bags.bag import Bag

MOST_OPEN = 2
Signature = tuple[tuple[str, int, int], ...]
_open: OrderedDict[tuple[Path, Signature], Bag] = OrderedDict()


def opened(path: Path) -> Bag:
    """The bag at a place; looked through again where its files have changed since.

    Args:
        path: as of `Bag`.

    Raises:
        BagError, PackageError: as `Bag`.
    """
    key = path.absolute(), _signature(path)
    bag = _open.get(key)
    if bag is None:
        bag = _open[key] = Bag(path)
    _open.move_to_end(key)
    while len(_open) > MOST_OPEN:
        # who still reads from it keeps it open
        _open.popitem(last=False)
    return bag


def _signature(path: Path) -> Signature:
    files = [path] if path.is_file() else sorted(path.iterdir()) if path.is_dir() else []
    stats = [(file.name, file.stat()) for file in files if file.is_file()]
    return tuple((name, stat.st_size, stat.st_mtime_ns) for name, stat in stats)
