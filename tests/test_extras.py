"""Optional packages: what is missing is told with the command that installs it."""

import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from elbowroom.errors import PackageError
from elbowroom.extras import PACKAGES, package

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
INSTALLED_AS = {"cv2": "opencv-python-headless", "foxglove": "foxglove-sdk", "numba_cuda": "numba-cuda"}


@pytest.mark.parametrize("name", PACKAGES)
def test_a_missing_package_is_told_with_the_command_that_installs_it(name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(PackageError) as told:
        package(name)
    words = shlex.split(str(told.value).partition("needs: ")[2])
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    assert any(word.startswith(INSTALLED_AS.get(name, name)) for word in words[4:])


@pytest.mark.parametrize("name", PACKAGES)
def test_the_extra_that_is_named_brings_the_package(name):
    extras = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    brought = [re.split(r"[\[<>=]", line)[0] for line in extras[PACKAGES[name][1]]]
    assert INSTALLED_AS.get(name, name) in brought


def test_what_is_there_is_imported():
    assert package("cv2") is sys.modules["cv2"]
