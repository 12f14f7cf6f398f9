import importlib
import inspect
import subprocess
import sys
from enum import Enum

import pytest

import elbowroom
from elbowroom import errors

PACKAGES = [
    "elbowroom",
    "elbowroom.geometry",
    "elbowroom.sensing",
    "elbowroom.machine",
    "elbowroom.reconstruct",
    "elbowroom.motion",
    "elbowroom.site",
    "elbowroom.monitor",
    "elbowroom.placement",
    "elbowroom.simulate",
    "elbowroom.view",
]
CONTRACT = {
    "VoxelGrid",
    "DepthCamera",
    "Intrinsics",
    "NoiseModel",
    "DepthFrame",
    "Machine",
    "ceiling_c_arm",
    "reconstruct",
    "Margin",
    "check_motion",
    "Motion",
    "Level",
    "Cause",
    "FreeSpace",
    "Evidence",
}
"""The names of the library's example: they do not change."""


@pytest.mark.parametrize("name", PACKAGES)
def test_all_is_true_and_sorted(name):
    package = importlib.import_module(name)
    assert len(set(package.__all__)) == len(package.__all__)
    for public in package.__all__:
        assert getattr(package, public) is not None
    assert set(package.__all__) <= set(dir(package))


def test_the_names_of_the_contract_are_public():
    assert set(elbowroom.__all__) >= CONTRACT


def test_reconstruct_is_the_function_whatever_was_imported_before():
    code = (
        "import elbowroom.motion, elbowroom.reconstruct.carve, elbowroom as er; "
        "from elbowroom.reconstruct import reconstruct; assert er.reconstruct is reconstruct; "
        "import elbowroom.reconstruct.views; assert er.reconstruct is reconstruct"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'octomap'"):
        elbowroom.octomap


@pytest.mark.parametrize("name", PACKAGES)
def test_every_public_name_has_a_docstring(name):
    package = importlib.import_module(name)
    assert package.__doc__
    for public in package.__all__:
        value = getattr(package, public)
        if not (inspect.isclass(value) or inspect.isfunction(value)):
            continue
        assert inspect.getdoc(value), f"{name}.{public}"
        if inspect.isclass(value) and not issubclass(value, Enum):
            for member, method in vars(value).items():
                if not member.startswith("_") and (
                    inspect.isfunction(method) or isinstance(method, property)
                ):
                    assert inspect.getdoc(method), f"{name}.{public}.{member}"


def test_all_errors_of_the_tree_are_one_kind():
    kinds = [kind for kind in vars(errors).values() if inspect.isclass(kind)]
    for kind in kinds:
        if not issubclass(kind, Warning):
            assert issubclass(kind, elbowroom.ElbowroomError)
        assert kind.__name__ in errors.__doc__


def test_importing_the_package_loads_no_kernels():
    code = (
        "import sys, elbowroom; print(sorted(m for m in sys.modules if m in ('numba', 'trimesh', 'scipy')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_free_space_of_a_bare_room_loads_nothing_that_reads_meshes():
    code = (
        "import sys, elbowroom as er; er.reconstruct, er.Machine, er.check_motion; "
        "print(sorted(m for m in sys.modules if m in ('trimesh', 'yourdfpy', 'scipy.ndimage', 'embreex')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
