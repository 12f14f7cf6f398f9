"""glTF files made by hand, so that what is in them is known to the byte."""

import json
import struct

import numpy as np

KINDS = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def a_box(lower, upper):
    """Corners and triangles of a box, outwards."""
    low, high = np.array([lower, upper], dtype=float)
    corners = np.array([[(high if n >> axis & 1 else low)[axis] for axis in range(3)] for n in range(8)])
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def y_up(points):
    """Points with z up as glTF has them."""
    return np.asarray(points, dtype=float)[:, [0, 2, 1]] * (1, 1, -1)


class Gltf:
    """A file that grows."""

    def __init__(self):
        self.data = b""
        self.content = {"asset": {"version": "2.0"}, "nodes": [], "meshes": []}
        self.content |= {"accessors": [], "bufferViews": []}

    def view(self, array):
        self.data += b"\0" * (-len(self.data) % 4)
        raw = array.tobytes()
        self.content["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)}
        )
        self.data += raw
        return len(self.content["bufferViews"]) - 1

    def accessor(self, rows, kind="f", **more):
        array = np.asarray(rows, dtype=kind)
        array = array.reshape(len(array), -1)
        self.content["accessors"].append(
            {
                "bufferView": self.view(array),
                "componentType": KINDS[kind],
                "count": len(array),
                "type": TYPES[array.shape[1]],
                **more,
            }
        )
        return len(self.content["accessors"]) - 1

    def mesh(self, corners, faces, **part):
        attributes = {"POSITION": self.accessor(corners), **part.pop("attributes", {})}
        indices = {} if faces is None else {"indices": self.accessor(np.ravel(faces), "H")}
        self.content["meshes"].append({"primitives": [{"attributes": attributes, **indices, **part}]})
        return len(self.content["meshes"]) - 1

    def node(self, name, **more):
        self.content["nodes"].append({"name": name, **more})
        return len(self.content["nodes"]) - 1

    def write(self, path, roots=None):
        if roots is not None:
            self.content |= {"scene": 0, "scenes": [{"nodes": list(roots)}]}
        self.data += b"\0" * (-len(self.data) % 4)
        self.content["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.content).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text
        body += struct.pack("<II", len(self.data), 0x004E4942) + self.data
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path
