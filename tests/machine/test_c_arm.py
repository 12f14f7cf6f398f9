import importlib.util
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import body_words
from elbowroom.machine.c_arm import CEILING_C_ARM_URDF, UNCHECKED_LINKS, ceiling_c_arm

BUILD = Path(__file__).resolve().parents[2] / "assets" / "ceiling_c_arm" / "build.py"
ISOCENTRE = np.array([0, 0, 1.1])


@pytest.fixture(scope="module")
def c_arm():
    return ceiling_c_arm()


@pytest.fixture(scope="module")
def builder():
    spec = importlib.util.spec_from_file_location("build", BUILD)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def points_of(machine, joints, links):
    placed = machine.world_from_links(joints)
    by_name = {link.name: link for link in machine.links}
    return np.concatenate(
        [by_name[name].vertices @ placed[name][:3, :3].T + placed[name][:3, 3] for name in links]
    )


def test_the_shipped_files_are_what_the_script_makes(builder, tmp_path):
    builder.build(tmp_path)
    made, shipped = sorted(tmp_path.iterdir()), sorted(CEILING_C_ARM_URDF.parent.iterdir())
    assert [path.name for path in made] == [path.name for path in shipped]
    for new, old in zip(made, shipped, strict=True):
        if new.suffix == ".urdf":
            assert new.read_text() == old.read_text()
        else:
            # the last digit of a sine may differ between machines
            new_mesh, old_mesh = (trimesh.load(path, process=False) for path in (new, old))
            np.testing.assert_allclose(new_mesh.triangles, old_mesh.triangles, atol=2e-5)


def test_all_bodies_are_closed_and_there_are_few_triangles():
    meshes = [trimesh.load(path) for path in CEILING_C_ARM_URDF.parent.glob("*.stl")]
    assert sum(len(mesh.faces) for mesh in meshes) <= 6000
    for mesh in meshes:
        assert mesh.is_watertight and mesh.is_winding_consistent and mesh.body_count == 1
        assert mesh.volume > 0


def test_the_joints_are_the_four_movements_with_their_limits(c_arm):
    assert c_arm.joint_names == ("long", "larm", "propeller", "carc")
    assert [joint.kind for joint in c_arm.joints] == ["prismatic", "revolute", "revolute", "revolute"]
    limits = (0.6, math.radians(90), math.radians(60), math.radians(45))
    for joint, limit in zip(c_arm.joints, limits, strict=True):
        assert (-joint.lower, joint.upper) == pytest.approx((limit, limit))
    assert set(c_arm.checked_links) == {"l_arm", "sleeve", "c_arc", "detector", "source"}


@pytest.mark.parametrize("joint", ("larm", "propeller", "carc"))
def test_every_turn_leaves_the_isocentre_where_it_is(c_arm, joint):
    turned = c_arm.world_from_links(dict.fromkeys(c_arm.joint_names, 0.0) | {joint: 0.7})
    for link in ("detector", "source"):
        np.testing.assert_allclose(turned[link][:3, 3], ISOCENTRE, atol=1e-9)


def test_detector_and_source_face_each_other_through_the_isocentre(c_arm):
    still = dict.fromkeys(c_arm.joint_names, 0.0)
    detector, source = (points_of(c_arm, still, [link]) - ISOCENTRE for link in ("detector", "source"))
    assert 0.3 < detector[:, 2].min() < source[:, 2].max() + 1.2
    assert -0.7 < source[:, 2].max() < -0.3
    face = detector[np.abs(detector[:, 2] - 0.39) < 1e-6]
    np.testing.assert_allclose(np.ptp(face[:, :2], axis=0), 0.4, atol=1e-4)


def test_the_checked_links_stay_in_the_watched_room_at_all_joint_positions(c_arm):
    corners = itertools.product(*([joint.lower, 0.0, joint.upper] for joint in c_arm.joints))
    rng = np.random.default_rng(0)
    inner = (rng.uniform([j.lower for j in c_arm.joints], [j.upper for j in c_arm.joints]) for _ in range(60))
    for positions in itertools.chain(corners, inner):
        joints = dict(zip(c_arm.joint_names, positions, strict=True))
        points = points_of(c_arm, joints, c_arm.checked_links)
        assert (np.abs(points[:, :2]) < 1.95).all()
        assert points[:, 2].min() > 0.12
        assert points[:, 2].max() < 2.47


def test_what_is_not_checked_hangs_at_the_ceiling(c_arm):
    points = points_of(c_arm, dict.fromkeys(c_arm.joint_names, 0.0), UNCHECKED_LINKS)
    assert points[:, 2].min() > 2.45
    assert points[:, 2].max() < 2.91


@pytest.mark.parametrize("larm", (-math.pi / 2, -0.7, 0.0, 0.7, math.pi / 2))
def test_a_patient_table_stands_in_the_opening_of_the_c(c_arm, larm):
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.02)
    corner = grid.lower_m + np.moveaxis(np.indices(grid.shape), 0, -1) * grid.voxel_size_m
    table = ((corner > (-0.67, -0.27, 0.87)) & (corner < (1.9, 0.25, 0.95))).all(axis=-1)
    body = body_words(c_arm, dict.fromkeys(c_arm.joint_names, 0.0) | {"larm": larm}, grid)
    assert (body != 0).any()
    assert not (body & bits.pack(table, grid)).any()


def test_it_hangs_where_it_is_told(c_arm):
    moved = np.eye(4)
    moved[:3, 3] = (0.5, -0.25, 0.1)
    other = ceiling_c_arm(world_from_base=moved)
    joints = dict.fromkeys(c_arm.joint_names, 0.1)
    for name, placed in c_arm.world_from_links(joints).items():
        np.testing.assert_allclose(other.world_from_links(joints)[name], moved @ placed, atol=1e-12)
    with pytest.raises(MachineError, match="world_from_base"):
        ceiling_c_arm(world_from_base=np.diag([1.0, 1.0, 2.0, 1.0]))
