"""What a file is by its first bytes, whatever its name says: for messages where it is not what was expected."""

from pathlib import Path

HEAD = 512
"""So many bytes are looked at."""
_POINTER = "a pointer of Git LFS, not the file; run git lfs pull where it comes from"
_BEGINS: tuple[tuple[bytes, str], ...] = (
    (b"version https://git-lfs", _POINTER),
    (b"\x89PNG\r\n\x1a\n", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image: it loses depths; record them as they come"),
    (b"II*\0", "a TIFF image"),
    (b"MM\0*", "a TIFF image"),
    (b"\x76\x2f\x31\x01", "an OpenEXR image"),
    (b"Pf\n", "a PFM image"),
    (b"PF\n", "a PFM image of three colours"),
    (b"\x93NUMPY", "an array of NumPy"),
    (b"PK\x03\x04", "a ZIP archive (or .npz, .3mf, .usdz)"),
    (b"\x1f\x8b", "compressed by gzip: unpack it"),
    (b"BZh", "compressed by bzip2: unpack it"),
    (b"\xfd7zXZ\0", "compressed by xz: unpack it"),
    (b"\x28\xb5\x2f\xfd", "compressed by zstd: unpack it"),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
    (b"#ROSBAG", "a bag of ROS 1"),
    (b"\x89MCAP0", "an MCAP file"),
    (b"SQLite format 3", "a SQLite database"),
    (b"%PDF", "a PDF"),
    (b"#usda", "USD"),
    (b"PXR-USDC", "USD"),
    (b"Kaydara FBX", "an FBX file"),
    (b"ISO-10303-21", "a STEP file"),
    (b"\0\x05\x16\x07", "a side file that macOS wrote (._name); delete it"),
)
_PAGES = (b"<!doctype html", b"<html")


def what_it_is(head: bytes) -> str | None:
    """In words, as a sentence goes on after "it is"; None: nothing that is known here.

    Args:
        head: its first bytes, `HEAD` or fewer.
    """
    if head.lstrip().lower().startswith(_PAGES):
        return "a web page: the download did not give the file"
    return next((words for begin, words in _BEGINS if head.startswith(begin)), None)


def head_of(path: Path) -> bytes:
    """The first bytes of a file."""
    with path.open("rb") as file:
        return file.read(HEAD)
