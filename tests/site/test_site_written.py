"""What the program writes as a site file, it reads."""

import pytest

from elbowroom.errors import SiteError
from elbowroom.files.yaml_file import read_yaml, write_yaml
from elbowroom.site import Site
from elbowroom.site.written import written, written_with_key

CONTENT = {
    "grid": {"origin_m": [0, 0, 0], "shape": [2, 2, 2], "voxel_size_m": 0.5},
    "simulated": {"cameras": 3},
}


def test_a_value_that_stands_twice_is_written_out_twice(tmp_path):
    point = [1.0, 2.0, 3.0]
    content = {"a": {"origin_m": point}, "b": {"origin_m": point}}
    assert read_yaml(write_yaml(tmp_path / "a.yaml", content, "two of one")) == content


def test_what_was_written_says_by_whom_and_is_a_site(tmp_path):
    path = written(CONTENT, tmp_path / "site.yaml", "written by a test")
    assert path.read_text().startswith("# written by a test\n")
    assert Site.load(path).simulated.cameras == 3


def test_what_is_no_site_is_not_called_written(tmp_path):
    with pytest.raises(SiteError, match=r"gird: unknown key \(did you mean grid\?\)"):
        written({**CONTENT, "gird": {}}, tmp_path / "site.yaml", "written by a test")


def test_a_key_is_replaced_and_all_else_stays_as_it_was_written(tmp_path):
    old = tmp_path / "old.yaml"
    text = (
        "# mine\ngrid: {origin_m: [0, 0, 0], shape: [2, 2, 2], voxel_size_m: 0.5}  # small\nsimulated: {}\n"
    )
    old.write_text(f"{text}watch:\n  reference: a.npz\n\n")
    new = written_with_key(Site.load(old), "watch", {"reference": "b.npz"}, tmp_path / "new.yaml", "a test")
    assert new.read_text().startswith(text) and new.read_text().count("watch:") == 1
    assert Site.load(new).entry.watch.reference == "b.npz"
    with pytest.raises(SiteError, match="is the site file itself"):
        written_with_key(Site.load(old), "watch", {}, old, "a test")
