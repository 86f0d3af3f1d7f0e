"""Small glTF files made by hand, as other software writes them or as nobody should."""

import base64
import json
import struct

import numpy as np

TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class Gltf:
    """Collects arrays and writes a .gltf with a data URI, a .bin beside it, or a .glb."""

    def __init__(self):
        self.binary = b""
        self.document = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "thing"}],
            "meshes": [{"primitives": []}],
            "accessors": [],
            "bufferViews": [],
        }

    def view(self, content, **more):
        self.document["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)} | more
        )
        self.binary += content + b"\0" * (-len(content) % 4)
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values, dtype, **more):
        array = np.asarray(values, dtype=f"<{dtype}")
        kind = KINDS[1 if array.ndim == 1 else array.shape[1]]
        self.document["accessors"].append(
            {"bufferView": self.view(array.tobytes()), "componentType": CODES[dtype], "count": len(array), "type": kind}
            | more
        )
        return len(self.document["accessors"]) - 1

    def primitive(self, positions=TRIANGLE, indices=None, mesh=0, **more):
        attributes = {"POSITION": self.accessor(positions, "f4")} | more.pop("attributes", {})
        primitive = {"attributes": attributes} | more
        if indices is not None:
            primitive["indices"] = self.accessor(indices, "u2")
        self.document["meshes"][mesh]["primitives"].append(primitive)
        return primitive

    def material(self, **more):
        self.document.setdefault("materials", []).append(more)
        return len(self.document["materials"]) - 1

    def write(self, path):
        buffer = {"byteLength": len(self.binary)}
        self.document["buffers"] = [buffer]
        if path.suffix == ".glb":
            text = json.dumps(self.document).encode()
            text += b" " * (-len(text) % 4)
            chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
            chunks += struct.pack("<II", len(self.binary), 0x004E4942) + self.binary
            path.write_bytes(struct.pack("<4sII", b"glTF", 2, len(chunks) + 12) + chunks)
        else:
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
            path.write_text(json.dumps(self.document))
        return path


def one_triangle():
    """A red triangle, the smallest right file."""
    gltf = Gltf()
    red = gltf.material(
        name="red", pbrMetallicRoughness={"baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": 0}
    )
    gltf.primitive(indices=[0, 1, 2], material=red)
    return gltf
