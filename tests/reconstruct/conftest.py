"""Walls made by hand and random pixels are what these tests look at: their values are not looked at."""

import sys

import pytest


@pytest.fixture(autouse=True, scope="module")
def unlooked(request):
    if request.module.__name__.endswith("looking"):
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys.modules["elbowroom.reconstruct.reconstruct"], "require_plausible", lambda *_: False)
        yield
