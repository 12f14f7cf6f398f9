"""A glTF 2.0 file: its JSON, its buffers, and which of its extensions change what is where."""

import base64
import binascii
import json
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

from elbowroom.errors import InputError

MAGIC = b"glTF"
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
APPLIED = ("KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility", "KHR_accessor_float64")
"""Extensions that say where surfaces are, and are obeyed."""
HARMLESS = re.compile(
    r"(KHR|EXT|MSFT|ADOBE|WEB3D|GOOGLE|NV|AGI|CESIUM|MPEG|VRMC|FB)_"
    r"(materials?_.*|texture_.*|lights?_.*|xmp.*|animation_pointer|ngon_encoding|articulations|stk_metadata"
    r"|mesh_features|structural_metadata|instance_features|techniques_webgl|packing_.*|lod|environment_map"
    r"|interactivity|node_hoverability|node_selectability|mesh_manifold)"
)
"""Extensions that change how surfaces look or what is told of them, not where they are."""
COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
"""Extensions that pack shapes; such a file may hold the shapes unpacked as well."""


@dataclass(frozen=True, slots=True, eq=False)
class GltfFile:
    """What a file holds before anything of it is placed.

    Args:
        path: of the file, for messages.
        content: its JSON.
        buffers: by number; None: one that stands for what is packed elsewhere, and holds nothing.
    """

    path: Path
    content: dict[str, Any]
    buffers: tuple[bytes | None, ...]

    def listed(self, key: str) -> Sequence[dict[str, Any]]:
        """A list of the JSON, such as "nodes"; empty where there is none."""
        return self.content.get(key) or ()


def gltf_file(path: Path) -> GltfFile:
    """Opens a .glb or .gltf file.

    Raises:
        InputError: not one, damaged, of another version, or in need of an extension that is not obeyed here.
    """
    data = path.read_bytes()
    is_binary = data[:4] == MAGIC
    if not is_binary and path.suffix.lower() == ".glb":
        raise InputError(f"{path}: not a GLB file; export binary glTF 2.0 (.glb)")
    try:
        text, binary = _chunks(data) if is_binary else (data, None)
        content = json.loads(text)
        if not isinstance(content, dict) or not isinstance(content.get("asset"), dict):
            raise ValueError("its JSON has no asset")
        version = str(content["asset"].get("version", ""))
        if version.split(".")[0] != "2":
            raise InputError(f"{path}: glTF version {version!r}; export glTF 2.0")
        _require_extensions(path, content)
        buffers = tuple(
            _buffer(path, n, given, binary) for n, given in enumerate(content.get("buffers") or ())
        )
    except InputError:
        raise
    except (ValueError, KeyError, TypeError, struct.error, binascii.Error, RecursionError) as error:
        kind = "GLB" if is_binary else "glTF"
        raise InputError(
            f"{path}: damaged {kind} ({type(error).__name__}: {error}); export it again"
        ) from error
    return GltfFile(path, content, buffers)


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """JSON and binary chunk of a GLB."""
    _, version, length = struct.unpack_from("<4sII", data)
    if version != 2:
        raise ValueError(f"version {version} of the container, expected 2")
    if len(data) < length:
        raise ValueError(f"{len(data)} bytes of {length}")
    chunks: dict[int, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", data, at)
        if at + 8 + size > length:
            raise ValueError("a chunk reaches beyond the file")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    return chunks[JSON_CHUNK], chunks.get(BINARY_CHUNK)


def _require_extensions(path: Path, content: dict[str, Any]) -> None:
    required = [str(name) for name in content.get("extensionsRequired") or ()]
    unknown = [name for name in required if name not in APPLIED and not HARMLESS.fullmatch(name)]
    if not unknown:
        return
    names = ", ".join(unknown)
    if any(name in COMPRESSED for name in unknown):
        raise InputError(f"{path}: its shapes are packed ({names}); export it without compression")
    raise InputError(f"{path}: needs the extension {names}, which is not known here; export it without")


def _buffer(path: Path, number: int, given: dict[str, Any], binary: bytes | None) -> bytes | None:
    uri, length = given.get("uri"), int(given["byteLength"])
    if uri is None:
        if number == 0 and binary is not None:
            data = binary
        elif any(name in (given.get("extensions") or {}) for name in COMPRESSED):
            return None
        else:
            raise ValueError(f"buffer {number} is not in the file")
    elif uri.startswith("data:"):
        head, _, body = uri.partition(",")
        data = base64.b64decode(body) if head.endswith(";base64") else unquote_to_bytes(body)
    elif "://" in uri:
        raise InputError(f"{path}: buffer {number} lies at {uri}; export one file with all in it (.glb)")
    else:
        beside = path.parent / unquote(uri)
        if not beside.is_file():
            raise InputError(f"{path}: buffer {number}: no file {beside}; copy it along, or export a .glb")
        data = beside.read_bytes()
    if len(data) < length:
        raise ValueError(f"buffer {number} holds {len(data)} bytes of {length}")
    return data
