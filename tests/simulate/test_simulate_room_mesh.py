"""One reader of rooms: the same room from every unit, axis and twist; what no room is, is refused or said."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.simulate.closed import merged_mesh, open_edge_count, signed_volume
from elbowroom.simulate.room_mesh import read_room_mesh
from reference.gltf_files import Gltf, a_box, y_up

BOX_M = np.array([[-1.9, -1.9, 0.0], [1.9, 1.9, 2.2]])
FLOOR = a_box((-1.9, -1.9, -0.1), (1.9, 1.9, 0.0))
A = a_box((0.4, -0.3, 0.0), (1.0, 0.5, 1.2))
B = a_box((-1.0, -0.3, 0.0), (-0.4, 0.5, 1.2))
ROOM = {"floor": FLOOR, "A": A, "B": B}


def glb(path, things=None, scale=1.0, turn=y_up):
    g = Gltf()
    roots = [
        g.node(name, mesh=g.mesh(turn(corners) * scale, faces))
        for name, (corners, faces) in (things or ROOM).items()
    ]
    return g.write(path, roots)


def obj(path, things=None, scale=1.0, turn=np.asarray):
    lines, count = [], 1
    for name, (corners, faces) in (things or ROOM).items():
        lines += [f"o {name}", *(f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in turn(corners) * scale)]
        lines += [f"f {a} {b} {c}" for a, b, c in faces + count]
        count += len(corners)
    path.write_text("\n".join(lines))
    return path


def extents(room):
    return {one.name: np.ptp(one.mesh.vertices, axis=0).round(3).tolist() for one in room.objects}


def test_a_room_is_the_same_from_every_format_axis_and_unit(tmp_path):
    right = read_room_mesh(glb(tmp_path / "a.glb"), box_m=BOX_M)
    assert not right.notes and all(one.is_solid for one in right.objects)
    for other in (
        read_room_mesh(glb(tmp_path / "b.glb", turn=np.asarray), up="z", box_m=BOX_M),
        read_room_mesh(glb(tmp_path / "c.glb", scale=1000.0), unit_m=0.001, box_m=BOX_M),
        read_room_mesh(obj(tmp_path / "d.obj"), box_m=BOX_M),
        read_room_mesh(obj(tmp_path / "e.obj", turn=y_up, scale=1 / 0.0254), up="y", unit_m=0.0254),
    ):
        assert not other.notes
        for one, again in zip(right.objects, other.objects, strict=True):
            np.testing.assert_allclose(one.mesh.vertices, again.mesh.vertices, atol=1e-6)
            np.testing.assert_array_equal(one.mesh.faces.shape, again.mesh.faces.shape)


@pytest.mark.parametrize(
    ("scale", "box_m", "words"),
    [
        (
            1000.0,
            None,
            r"'floor' is 3,800 m long; this looks like millimetres: say mesh_unit_m: 0.001 .* by 0.001",
        ),
        (100.0, None, r"'floor' is 380 m long; this looks like centimetres: say mesh_unit_m: 0.01 "),
        (100.0, BOX_M, r"centimetres"),
        (1 / 0.0254, BOX_M, r"'floor' is 150 m long; this looks like inches: .* --unit 0.0254"),
        (0.01, None, r"only 0.038 m long; .* mesh_unit_m: 100 .* scale the room by 100 "),
        (0.001, BOX_M, r"only 0.0038 m long; .* by 1000 "),
    ],
)
def test_a_size_that_no_room_has_is_refused_with_the_factor_that_fits(tmp_path, scale, box_m, words):
    with pytest.raises(InputError, match=words):
        read_room_mesh(glb(tmp_path / "a.glb", scale=scale), box_m=box_m)


def test_furniture_alone_in_inches_or_feet_is_said(tmp_path):
    tall = {"A": a_box((-1.5, -1.5, 0), (-0.9, -0.9, 2.0)), "B": a_box((0.7, 1, 0), (1.3, 1.2, 1.2))}
    inches = read_room_mesh(obj(tmp_path / "a.obj", tall, 1 / 0.0254), box_m=BOX_M)
    assert "if it is in inches, say mesh_unit_m: 0.0254" in inches.notes[0]
    feet = read_room_mesh(glb(tmp_path / "a.glb", scale=1 / 0.3048), box_m=BOX_M)
    assert "if it is in feet, say mesh_unit_m: 0.3048" in feet.notes[0]


def test_a_hall_about_a_cell_is_no_matter(tmp_path):
    hall = {"hall": a_box((-12, -12, -0.2), (12, 12, 0)), "wall": a_box((-12, 11.8, 0), (12, 12, 7)), "A": A}
    assert not read_room_mesh(glb(tmp_path / "a.glb", hall), box_m=BOX_M).notes


@pytest.mark.parametrize("name", ["floor", "Cube.001"])
def test_a_floor_that_stands_upright_is_said(tmp_path, name):
    things = {name: FLOOR, "A": A, "B": B}
    (note,) = read_room_mesh(glb(tmp_path / "a.glb", things, turn=np.asarray), box_m=BOX_M).notes
    assert "upright" in note and "say mesh_up: z in the site file or --up z" in note
    (note,) = read_room_mesh(obj(tmp_path / "a.obj", things, turn=y_up), box_m=BOX_M).notes
    assert "upright" in note and "--up y" in note


@pytest.mark.parametrize(
    "things",
    [
        {"A": A, "B": B},
        {"wall": a_box((-2, 1.9, 0), (2, 2, 2.5)), "A": A, "floor lamp": a_box((0, 0, 0), (0.2, 0.2, 1.8))},
        {"floor skirting": a_box((-2, -2, 0), (2, -1.98, 0.1)), "floor": FLOOR},
        {f"wall {n}": a_box(low, high) for n, (low, high) in enumerate([
            ((-2, -2, 0), (2, -1.9, 2.5)), ((-2, 1.9, 0), (2, 2, 2.5)),
            ((-2, -2, 0), (-1.9, 2, 2.5)), ((1.9, -2, 0), (2, 2, 2.5))])},
    ],
)  # fmt: skip
def test_rooms_that_stand_are_not_said_to_lie(tmp_path, things):
    assert not read_room_mesh(glb(tmp_path / "a.glb", things), box_m=BOX_M).notes


def test_faces_inside_out_are_turned_but_for_the_rooms_shell(tmp_path):
    shell = a_box((-2, -2, 0), (2, 2, 2.5))
    things = {"shell": (shell[0], shell[1][:, ::-1]), "A": (A[0], A[1][:, ::-1]), "B": B}
    room = read_room_mesh(glb(tmp_path / "a.glb", things))
    by_name = {one.name: one for one in room.objects}
    assert by_name["shell"].is_shell and not by_name["shell"].is_solid and by_name["A"].is_solid
    assert signed_volume(by_name["A"].mesh) == pytest.approx(0.576, rel=1e-5)
    assert "faces of 'A' point inwards" in room.notes[0]


@pytest.mark.parametrize("again", [[slice(0, 3)], [slice(None)], [slice(None), slice(2, 5)]])
def test_faces_that_are_there_twice_or_from_both_sides_leave_a_box_closed(again):
    corners, faces = A
    for more in (faces, faces[:, ::-1]):
        mesh = merged_mesh(corners, np.concatenate([faces, *(more[part] for part in again)]))
        assert open_edge_count(mesh) == 0 and signed_volume(mesh) == pytest.approx(0.576)


def test_a_sheet_of_two_sides_stays_as_it_is():
    sheet = trimesh.creation.box((1, 1, 1)).faces[:2]
    corners = trimesh.creation.box((1, 1, 1)).vertices
    assert len(merged_mesh(corners, np.concatenate([sheet, sheet[:, ::-1]])).faces) == 4
