"""Files that are not what they seem: a named error with the file, the place and the remedy."""

from __future__ import annotations

import json
import struct
import zipfile
from pathlib import Path

import numpy as np

import radiosity as rad
from radiosity.errors import FileFormatError, GeometryError, MissingFileError, RadiosityWarning, SceneError

from ..files.fuzz import MTL, OBJ, seeds
from ..files.gltf_by_hand import Gltf, one_triangle
from .case import Case, Run, refused, value, warned

G = "hostile files"
PENTAGON = [(0, 0), (3, 0), (3, 2), (1, 0.5), (0, 2)]
KEPT = Path(__file__).resolve().parents[1] / "files" / "kept" / "solution_v1.npz"


def read(name, content, **others):
    """Read a file of this content, others beside it."""

    def do(folder):
        for other, text in others.items():
            (folder / other.replace("_", ".")).write_bytes(text)
        (folder / name).write_bytes(content)
        return rad.read_solution(folder / name) if name.endswith(".npz") else rad.read_scene(folder / name)

    return do


def gltf(change):
    """Read a small glTF whose document was changed."""

    def do(folder):
        made = one_triangle()
        change(made.document)
        return rad.read_scene(made.write(folder / "scene.gltf"))

    return do


def damaged(name, content, words, error=FileFormatError, **others) -> Run:
    return refused(read(name, content, **others), error, words)


def pentagon(first):
    order = [(first + k) % 5 + 1 for k in range(5)]
    text = "".join(f"v {x} {y} 0\n" for x, y in PENTAGON) + f"f {' '.join(map(str, order))}\n"
    return text.encode()


def pentagon_areas():
    import tempfile

    areas = []
    for first in range(5):
        with tempfile.TemporaryDirectory() as name:
            areas.append(rad.subdivide(read("scene.obj", pentagon(first))(Path(name))).area.sum())
    return areas


def bomb(folder):
    """A solution whose header would unpack to a thousand times its size."""
    with zipfile.ZipFile(folder / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("header.npy", b"\x93NUMPY\x01\x00" + b"\0" * (1 << 22))
    return rad.read_solution(folder / "a.npz")


def newer(folder):
    with np.load(KEPT) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(bytes(arrays["header"])) | {"version": 99}
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(folder / "a.npz", **arrays)
    return rad.read_solution(folder / "a.npz")


def instances(folder):
    made = Gltf()
    made.primitive(np.zeros((3000, 3)), material=made.material())
    made.document["nodes"] = [{"mesh": 0}] * 6_000
    made.document["scenes"] = [{"nodes": list(range(6_000))}]
    return rad.read_scene(made.write(folder / "scene.gltf"))


def outside(document):
    document["images"], document["textures"] = [{"uri": "../secret.png"}], [{"source": 0}]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]


def a_folder(folder):
    (folder / "scene.glb").mkdir()
    return rad.read_scene(folder / "scene.glb")


def colours(folder):
    made = Gltf()
    made.primitive(attributes={"COLOR_0": made.accessor([[1, 0, 0], [0, 1, 0]], "f4")})
    return rad.read_scene(made.write(folder / "scene.gltf"))


GLB = seeds("GLB")[0]["scene.glb"]
STL = seeds("STL")[0]["scene.stl"]
PLY = seeds("PLY")[0]["scene.ply"]
OFF = seeds("OFF")[0]["scene.off"]
NPZ = KEPT.read_bytes()
NAN = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, float("nan"), 0, 0)
POINTS = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\n"
DRACO = {"extensionsRequired": ["KHR_draco_mesh_compression"]}

CASES = [
    Case(G, "empty file", "a .glb of no bytes", "refused by name", damaged("scene.glb", b"", "is empty")),
    Case(G, "web page", "the HTML of a failed download as .glb", "refused: download the file itself",
         damaged("scene.glb", b"<!DOCTYPE html><html>404", "is a web page")),
    Case(G, "archive", "a ZIP as .obj", "refused: unpack it", damaged("scene.obj", b"PK\x03\x04...", "a ZIP archive; unpack")),
    Case(G, "compressed", "a gzip as .stl", "refused: unpack it", damaged("scene.stl", b"\x1f\x8b\x08", "gzip.*unpack")),
    Case(G, "pointer", "a Git LFS pointer as .ply", "refused: git lfs pull",
         damaged("scene.ply", b"version https://git-lfs.github.com/spec/v1\n", "git lfs pull")),
    Case(G, "unknown suffix", "a .fbx", "refused: what is read", damaged("scene.fbx", b"Kaydara", r"known are \.glb")),
    Case(G, "no such file", "a name without a file", "refused by name",
         refused(lambda folder: rad.read_scene(folder / "none.glb"), MissingFileError, "there is no file none.glb")),
    Case(G, "folder", "a folder in place of a file", "refused by name", refused(a_folder, FileFormatError, "is a folder")),
    Case(G, "GLB cut in half", "half of a GLB", "refused: truncated", damaged("a.glb", GLB[: len(GLB) // 2], "truncated")),
    Case(G, "GLB with a tail", "a GLB and 8 bytes more", "refused: damaged", damaged("a.glb", GLB + b"\0" * 8, "damaged")),
    Case(G, "four thousand million elements", "an accessor whose count is 4 294 967 295", "refused, nothing allocated",
         refused(gltf(lambda d: d["accessors"][0].update(count=2**32 - 1)), FileFormatError, r"accessors\[0\] needs")),
    Case(G, "elements from nowhere", "1e9 elements without data", "refused, nothing allocated",
         refused(gltf(lambda d: (d["accessors"][0].pop("bufferView"), d["accessors"][0].update(count=10**9))),
                 FileFormatError, "no bufferView")),
    Case(G, "buffer out of range", "a view beyond its buffer", "refused with the byte",
         refused(gltf(lambda d: d["bufferViews"][0].update(byteLength=10**9)), FileFormatError, "ends at byte 1000000000")),
    Case(G, "index out of range", "corner 9 of 3", "refused with the numbers",
         damaged("scene.off", OFF.replace(b"3 1 3 0", b"3 1 99 0"), "names vertex 99; there are 8")),
    Case(G, "node in a circle", "a node that is its own child", "refused by name",
         refused(gltf(lambda d: d["nodes"][0].update(children=[0])), FileFormatError, "is its own ancestor")),
    Case(G, "path out of the folder, glTF", "a picture at ../secret.png", "refused, not opened",
         refused(gltf(outside), FileFormatError, "only files in the folder of the scene are read")),
    Case(G, "path out of the folder, OBJ", "mtllib ../secret.mtl", "refused, not opened",
         damaged("scene.obj", b"mtllib ../secret.mtl\n" + POINTS, "line 1.*only files in the folder")),
    Case(G, "deep JSON", "100 000 brackets", "refused by name", damaged("scene.gltf", b"[" * 100_000, "nested too deeply")),
    Case(G, "many copies", "6 000 nodes of one mesh of 1000 triangles", "refused before they are made",
         refused(instances, FileFormatError, "6000000 triangles")),
    Case(G, "compression that is not read", "a glTF that requires Draco", "refused: export without",
         refused(gltf(lambda d: d.update(DRACO)), FileFormatError, "requires KHR_draco_mesh_compression")),
    Case(G, "wrong number of colours", "2 vertex colours for 3 vertices", "refused with the numbers",
         refused(colours, FileFormatError, "COLOR_0 has 2 elements, but there are 3 vertices")),
    Case(G, "OBJ index out of range", "f 1 2 9", "refused with the line",
         damaged("scene.obj", POINTS + b"f 1 2 9\n", "line 6: vertex 9 does not exist; 5 come before")),
    Case(G, "OBJ cut within a line", "f 1 2 3 with its last line cut", "said",
         warned(read("scene.obj", POINTS + b"f 1 2 3"), RadiosityWarning, "the last line has no end: was the file cut off")),
    Case(G, "text that is not UTF-8", "a name in Latin-1", "refused with the line",
         damaged("scene.obj", POINTS + b"o K\xfcche\nf 1 2 3\n", "line 6 is not UTF-8 text.*save it as UTF-8")),
    Case(G, "comment in Latin-1", "# Küche, not in UTF-8", "read all the same, 0.5 m²",
         value(lambda: _area(b"# K\xfcche\n" + POINTS + b"f 1 2 3\n"), 0.5)),
    Case(G, "HTML as a material library", "a web page as .mtl", "refused with the line",
         damaged("scene.obj", OBJ, r"scene\.mtl, line 1: '<html>' before any newmtl", scene_mtl=b"<html>\n")),
    Case(G, "reflectance above one", "Kd 1.5", "refused by material",
         damaged("scene.obj", OBJ, r"reflectance 1\.5 in channel 0", SceneError, scene_mtl=MTL.replace(b"0.7", b"1.5", 1))),
    Case(G, "concave pentagon", "from each of its five corners", "its area, 3.75 m²", value(pentagon_areas, 3.75, rel=1e-14)),
    Case(G, "pentagon that crosses itself", "corners 1 3 2 4 5", "refused with the line",
         damaged("scene.obj", POINTS + b"f 1 3 2 4 5\n", "line 6: a polygon is flat or crosses itself")),
    Case(G, "STL cut in half", "half of a binary STL", "refused with the sizes",
         damaged("scene.stl", STL[: len(STL) // 2], "no whole STL: it has 342 bytes; its header says 12 triangles")),
    Case(G, "STL of another count", "12 triangles said to be 13", "refused with the sizes",
         damaged("scene.stl", STL[:80] + struct.pack("<I", 13) + STL[84:], "its header says 13 triangles")),
    Case(G, "corner that is no number", "a NaN in an STL", "refused with the vertex",
         damaged("scene.stl", b"\0" * 80 + struct.pack("<I", 1) + NAN, "vertices are not finite", GeometryError)),
    Case(G, "corner of 1e80 m", "v 1e80 0 0", "refused with the number",
         damaged("scene.obj", POINTS + b"v 1e80 0 0\nf 1 2 6\n", r"coordinates reach 1e\+80 m", GeometryError)),
    Case(G, "PLY that promises more", "8 faces said, 7 there", "refused: truncated",
         damaged("scene.ply", PLY.replace(b"face 7", b"face 8"), "promises 8 of 'face' and has 7: truncated")),
    Case(G, "PLY that promises fewer", "6 faces said, 7 there", "refused: damaged",
         damaged("scene.ply", PLY.replace(b"face 7", b"face 6"), "goes on behind the last element")),
    Case(G, "OFF cut in half", "half of an OFF", "refused: truncated",
         damaged("scene.off", OFF[: len(OFF) // 2], "truncated|expected a vertex")),
    Case(G, "solution cut short", "a .npz without its end", "refused by name",
         damaged("a.npz", NPZ[:-100], "no numpy archive, or it was cut short")),
    Case(G, "solution with a flipped bit", "one bit of a .npz turned", "refused: the checksum",
         damaged("a.npz", _flipped := NPZ[:3000] + bytes([NPZ[3000] ^ 1]) + NPZ[3001:], "damaged|JSON|missing")),
    Case(G, "solution as a bomb", "4 MiB of zeros, compressed a thousandfold", "refused, not unpacked",
         refused(bomb, FileFormatError, "compressed")),
    Case(G, "solution of a newer version", "version 99 of the format", "refused: install the newer",
         refused(newer, FileFormatError, "version 99 of the format.*install the newer")),
]  # fmt: skip


def _area(content):
    import tempfile

    with tempfile.TemporaryDirectory() as name:
        return rad.subdivide(read("scene.obj", content)(Path(name))).area.sum()
