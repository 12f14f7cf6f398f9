"""glTF: whatever carries a cabinet to its place, it stands there, faces outwards; or the file is refused by name."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.files.mesh.read import read_mesh
from reference.gltf_files import Gltf, a_box, y_up

LOWER, UPPER = np.array([0.4, -0.3, 0.0]), np.array([1.0, 0.5, 1.2])
CORNERS, FACES = a_box(LOWER, UPPER)
STANDS = y_up(CORNERS)


def volume(thing):
    a, b, c = np.moveaxis(thing.vertices[thing.faces], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def plain(g):
    return [g.node("A", mesh=g.mesh(STANDS, FACES))]


def mirrored(axis):
    def make(g):
        scale = [1.0, 1.0, 1.0]
        scale[axis] = -1.0
        return [g.node("A", mesh=g.mesh(STANDS * scale, FACES[:, ::-1]), scale=scale)]

    return make


def mirrored_in_mirrored(g):
    inner = g.node("A", mesh=g.mesh(STANDS * (-1, -1, 1), FACES), scale=[-1, 1, 1])
    return [g.node("holder", children=[inner], scale=[1, -1, 1])]


def by_matrix(g):
    matrix = np.eye(4)
    matrix[:3, 3] = (0.5, 0.25, -2.0)
    return [g.node("A", mesh=g.mesh(STANDS - matrix[:3, 3], FACES), matrix=matrix.T.ravel().tolist())]


def turned(g):
    half = np.sqrt(0.5)
    # a quarter about y: x to -z, z to x
    before = STANDS[:, [2, 1, 0]] * (-1, 1, 1)
    return [g.node("A", mesh=g.mesh(before, FACES), rotation=[0, half, 0, half])]


def quantised(g):
    low, high = STANDS.min(axis=0), STANDS.max(axis=0)
    whole = np.rint((STANDS - low) / (high - low) * 65535)
    mesh = g.mesh(STANDS, FACES)
    position = g.accessor(whole, "H", normalized=True)
    g.content["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"] = position
    g.content["extensionsRequired"] = [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_materials_unlit",
    ]
    return [g.node("A", mesh=mesh, translation=low.tolist(), scale=(high - low).tolist())]


def instanced(g):
    put = g.accessor([[0.25, 0, 0]])
    extensions = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": put}}}
    return [g.node("A", mesh=g.mesh(STANDS - (0.25, 0, 0), FACES), extensions=extensions)]


def skinned(g):
    bone = g.node("bone", translation=[-1.4, 0, 0])
    joints = g.accessor(np.zeros((8, 4)), "B")
    weights = g.accessor(np.tile([1.0, 0, 0, 0], (8, 1)))
    mesh = g.mesh(STANDS + (1.4, 0, 0), FACES, attributes={"JOINTS_0": joints, "WEIGHTS_0": weights})
    g.content["skins"] = [{"joints": [bone]}]
    return [bone, g.node("A", mesh=mesh, skin=0, translation=[9, 9, 9])]


def morphed(g):
    mesh = g.mesh(STANDS - (0, 0, 0.5), FACES)
    by = g.accessor(np.tile([0, 0, 1.0], (8, 1)))
    g.content["meshes"][mesh]["primitives"][0]["targets"] = [{"POSITION": by}]
    g.content["meshes"][mesh]["weights"] = [0.0]
    return [g.node("A", mesh=mesh, weights=[0.5])]


def sparse(g):
    corners = STANDS.copy()
    corners[3] = 99.0
    mesh = g.mesh(corners, FACES)
    g.content["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": g.view(np.array([3], "H")), "componentType": 5123},
        "values": {"bufferView": g.view(STANDS[3].astype("f"))},
    }
    return [g.node("A", mesh=mesh)]


def without_indices(g):
    return [g.node("A", mesh=g.mesh(STANDS[FACES].reshape(-1, 3), None))]


def fans(g):
    mesh = g.mesh(STANDS, None, mode=6, indices=g.accessor(FACES[:2].ravel()[[0, 1, 2, 5]], "H"))
    parts = g.content["meshes"][mesh]["primitives"]
    for n in range(2, 12, 2):
        quad = [FACES[n][0], FACES[n][1], FACES[n + 1][2], FACES[n][2]]
        # a strip of two: its second triangle is turned by itself
        parts.append({**parts[0], "mode": 5, "indices": g.accessor([quad[k] for k in (0, 1, 2, 3)], "H")})
    return [g.node("A", mesh=mesh)]


def draco_with_a_way_out(g):
    mesh = g.mesh(STANDS, FACES, extensions={"KHR_draco_mesh_compression": {"bufferView": 0}})
    g.content["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    return [g.node("A", mesh=mesh)]


WAYS = (
    plain, mirrored(0), mirrored(1), mirrored(2), mirrored_in_mirrored, by_matrix, turned, quantised, instanced,
    skinned, morphed, sparse, without_indices, fans, draco_with_a_way_out,
)  # fmt: skip


@pytest.mark.parametrize("make", WAYS)
def test_a_cabinet_stands_where_the_file_puts_it(tmp_path, make):
    g = Gltf()
    (thing,) = read_mesh(g.write(tmp_path / "a.glb", make(g))).objects
    used = thing.vertices[np.unique(thing.faces)]
    assert used.min(axis=0) == pytest.approx(STANDS.min(axis=0), abs=2e-5)
    assert used.max(axis=0) == pytest.approx(STANDS.max(axis=0), abs=2e-5)
    assert volume(thing) == pytest.approx(np.prod(UPPER - LOWER), rel=1e-4)


def test_what_trimesh_writes_reads_as_trimesh_reads_it(tmp_path):
    rng, scene = np.random.default_rng(3), trimesh.Scene()
    for n in range(4):
        shape = trimesh.creation.icosphere(subdivisions=1, radius=0.3 + 0.1 * n)
        scene.add_geometry(
            shape,
            node_name=f"ball {n}",
            transform=trimesh.transformations.random_rotation_matrix(rng.random(3)),
        )
    path = tmp_path / "balls.glb"
    path.write_bytes(scene.export(file_type="glb"))
    theirs = trimesh.load_scene(path, process=False)
    found = read_mesh(path)
    assert [one.name for one in found.objects] == sorted(theirs.graph.nodes_geometry)
    for one in found.objects:
        pose, name = theirs.graph[one.name]
        placed = theirs.geometry[name].vertices @ pose[:3, :3].T + pose[:3, 3]
        np.testing.assert_allclose(one.vertices, placed, atol=1e-9)
        np.testing.assert_array_equal(one.faces, theirs.geometry[name].faces)


def required(name):
    def make(g):
        g.content["extensionsRequired"] = [name]
        return plain(g)

    return make


def draco_alone(g):
    roots = draco_with_a_way_out(g)
    for accessor in g.content["accessors"]:
        del accessor["bufferView"]
    return roots


def bone_that_is_not_there(g):
    roots = skinned(g)
    g.content["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = g.accessor(np.full((8, 4), 7), "B")
    return roots


def without_weights(g):
    roots = skinned(g)
    del g.content["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"]
    return roots


def corner_that_is_not_there(g):
    return [g.node("A", mesh=g.mesh(STANDS, FACES + 1))]


def cut_short(g):
    roots = plain(g)
    g.content["accessors"][0]["count"] = 99
    return roots


def holds_itself(g):
    roots = plain(g)
    g.content["nodes"][0]["children"] = [0]
    return roots


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (required("KHR_draco_mesh_compression"), "packed .KHR_draco_mesh_compression.; export it without"),
        (required("EXT_meshopt_compression"), "packed .EXT_meshopt_compression."),
        (required("ACME_shapes"), "needs the extension ACME_shapes"),
        (draco_alone, "mesh 0: its shape is packed .KHR_draco"),
        (bone_that_is_not_there, "'A': hangs on bone 7 of 1; export it with modifiers applied"),
        (without_weights, "mesh 0: hangs on bones, .* modifiers applied"),
        (corner_that_is_not_there, "mesh 0: a face names vertex 8 of 8"),
        (cut_short, "mesh 0: accessor 0 cannot be read"),
        (holds_itself, "'A' hangs"),
    ],
)
def test_what_cannot_be_read_is_refused_by_name(tmp_path, make, words):
    g = Gltf()
    path = g.write(tmp_path / "a.glb", make(g))
    with pytest.raises(InputError, match=words) as caught:
        read_mesh(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_what_is_left_out_is_said(tmp_path):
    g = Gltf()
    line = g.mesh(STANDS, None, mode=1)
    hidden = {"KHR_node_visibility": {"visible": False}}
    roots = [*plain(g), g.node("wire", mesh=line), g.node("ghost", mesh=1, extensions=hidden)]
    g.node("elsewhere", mesh=1)
    file = read_mesh(g.write(tmp_path / "a.glb", roots))
    assert [one.name for one in file.objects] == ["A"]
    notes = " ".join(file.notes)
    assert "'wire' holds no faces" in notes and "hides them: ghost" in notes
    assert "not in the scene that the file shows: elsewhere" in notes


def test_of_several_scenes_the_file_says_which(tmp_path):
    g = Gltf()
    a = plain(g)[0]
    b = g.node("B", mesh=0)
    g.content |= {"scenes": [{"nodes": [a]}, {"nodes": [b]}], "scene": 1}
    assert [one.name for one in read_mesh(g.write(tmp_path / "a.glb")).objects] == ["B"]
    del g.content["scene"]
    with pytest.raises(InputError, match="holds 2 scenes"):
        read_mesh(g.write(tmp_path / "b.glb"))
