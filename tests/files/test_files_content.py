"""A file is told by its first bytes, whatever its name says."""

import gzip
import io

import numpy as np
import pytest
from PIL import Image

from elbowroom.files.content import HEAD, head_of, what_it_is


def picture(form):
    out = io.BytesIO()
    Image.new("L", (4, 4)).save(out, format=form)
    return out.getvalue()


def array(save):
    out = io.BytesIO()
    save(out, np.zeros(3))
    return out.getvalue()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (picture("TIFF"), "a TIFF image"),
        (picture("JPEG"), "a JPEG image"),
        (picture("PNG"), "a PNG image"),
        (array(np.save), "an array of NumPy"),
        (array(np.savez), "a ZIP archive"),
        (gzip.compress(b"<robot/>", mtime=0), "compressed by gzip"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "a pointer of Git LFS"),
        (b"\n<!DOCTYPE html><html>404</html>", "a web page"),
    ],
)
def test_what_others_wrote_is_named(tmp_path, content, words):
    (tmp_path / "it").write_bytes(content)
    assert words in (what_it_is(head_of(tmp_path / "it")) or "")


@pytest.mark.parametrize(
    "content", [b"", b"solid part\n facet", b"<robot name='r'/>", bytes(HEAD), b"P5\n4 4\n65535\n"]
)
def test_what_is_read_here_is_nothing_else(content):
    assert what_it_is(content) is None
