"""Files damaged on purpose, by a seeded mutator, and what the readers make of them.

``python -m tests.files.fuzz GLB 5000 deep`` reads 5000 mutants of a format in a process whose memory is limited, cuts
what it can read into patches, and prints what happened as JSON. The tests run it; a mutant is made again by its format
and number (`mutant`).
"""

from __future__ import annotations

import contextlib
import faulthandler
import io
import json
import re
import resource
import signal
import struct
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import radiosity as rad
from radiosity.errors import RadiosityError

SECONDS, BYTES = 5, 500_000_000
EVIL = [
    b"0", b"-1", b"1", b"2", b"3", b"255", b"65536", b"2147483647", b"-2147483648", b"4294967295", b"4294967296",
    b"1e9", b"1e38", b"1e39", b"1e300", b"9e999", b"-1e300", b"1e-320", b"nan", b"inf", b"-inf", b"NaN", b"0x10",
    b"1.", b".5", b"1,5", b"1e", b"--1", b"99999999999999999999999999", b"true", b"null", b"\"x\"", b"[]", b"{}", b"",
]  # fmt: skip
WORDS = [0, 1, 2, 3, 0x7F, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFFE, 0x7FC00000, 0x7F800000,
         0xFF800000, 0x7F7FFFFF, 1 << 20, 1 << 28, 1 << 30]  # fmt: skip
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

Files = dict[str, bytes]  # the first is the one that is read; others lie beside it


class Hang(BaseException):
    """A read took too long."""


# Seeds: small whole files of each format


def _box(form: str) -> bytes:
    import trimesh

    content = trimesh.creation.box((1, 2, 3)).export(file_type=form)
    return content.encode() if isinstance(content, str) else content


def _glb(scene: rad.Scene) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        rad.write_scene(scene, Path(folder) / "scene.glb")
        return (Path(folder) / "scene.glb").read_bytes()


def _plain_glb() -> bytes:
    """A room as others write it: no extras, short indices, a picture, node transforms, a sparse accessor."""
    from .gltf_by_hand import Gltf

    gltf = Gltf()
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [k for a, b, c, d in faces for k in (a, c, b, a, d, c)]
    lamp = gltf.material(
        name="lamp",
        emissiveFactor=[1, 0.5, 0.25],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 4}},
    )
    gltf.document["images"] = [{"uri": "data:image/png;base64," + PIXEL, "mimeType": "image/png"}]
    gltf.document["textures"] = [{"source": 0}]
    wood = gltf.material(name="wood", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    gltf.primitive(corners, triangles, material=lamp)
    uv = gltf.accessor([[x, y] for x in (0, 1) for y in (0, 1) for _ in (0, 1)], "f4")
    gltf.primitive(corners, triangles, material=wood, attributes={"TEXCOORD_0": uv})
    gltf.document["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": gltf.view(np.array([3], "<u1").tobytes()), "componentType": 5121},
        "values": {"bufferView": gltf.view(np.array([[0, 1, 1.5]], "<f4").tobytes())},
    }
    gltf.document["nodes"] = [
        {"mesh": 0, "name": "a", "translation": [3, 0, 0], "children": [1]},
        {"mesh": 0, "name": "b", "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, -1]},
    ]
    with tempfile.TemporaryDirectory() as folder:
        return gltf.write(Path(folder) / "scene.glb").read_bytes()


PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR4nGP8z8DAwMDAxMDAwMDAAAANHQEDasKb6QAAAABJRU5ErkJggg=="
OBJ = b"""mtllib scene.mtl
# a room of polygons
o room
v 0 0 0
v 4 0 0
v 4 0 3
v 0 0 3
v 0 2.5 0
v 4 2.5 0
v 4 2.5 3
v 0 2.5 3
vt 0 0
vt 1 0
vt 1 1
vn 0 1 0
usemtl white
f 1/1/1 4/2/1 3/3/1 2/1/1
f 5 6 7 8
g walls
usemtl red
f -8 -7 -3 -4
f 2 3 7 \\
 6
f 3 4 8 7
f 4 1 5 8
o star
v 1 1 1
v 2 1 1
v 2 2 1
v 1.5 1.2 1
v 1 2 1
usemtl lamp
f 9 10 11 12 13
l 1 2
"""
MTL = b"newmtl white\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.6 0.1 0.1\nKs 0 0 1\nnewmtl lamp\nKd 0.5 0.5 0.5\nKe 10 8 5\n"


def _ply(order: str) -> bytes:
    vertices = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7, 3]]
    head = (
        f"ply\nformat {order} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 7\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nend_header\n"
    ).encode()
    if order == "ascii":
        rows = [" ".join(map(str, v)) for v in vertices]
        rows += [f"{len(f)} {' '.join(map(str, f))} {40 * (k % 3)} 90 200" for k, f in enumerate(faces)]
        return head + "\n".join(rows).encode() + b"\n"
    mark = "<" if "little" in order else ">"
    body = b"".join(struct.pack(f"{mark}3f", *v) for v in vertices)
    body += b"".join(struct.pack(f"{mark}B{len(f)}i3B", len(f), *f, 40 * (k % 3), 90, 200) for k, f in enumerate(faces))
    return head + body


def _npz() -> bytes:
    solution = rad.solve(rad.scenes.furnace(), estimator=rad.Analytic(), bounces=2, patch_count=6)
    with tempfile.TemporaryDirectory() as folder:
        solution.save(Path(folder) / "a.npz")
        return (Path(folder) / "a.npz").read_bytes()


def seeds(form: str) -> list[Files]:
    """Whole files of a format."""
    if form == "GLB":
        found = [_glb(rad.scenes.furnace()), _glb(rad.scenes.open_rug()), _plain_glb()]
        return [{"scene.glb": content} for content in found]
    if form == "OBJ":
        return [{"scene.obj": OBJ, "scene.mtl": MTL}]
    if form == "PLY":
        orders = ("ascii", "binary_little_endian", "binary_big_endian")
        return [{"scene.ply": _ply(order)} for order in orders]
    if form == "STL":
        return [{"scene.stl": _box("stl")}, {"scene.stl": _box("stl_ascii")}]
    if form == "OFF":
        return [{"scene.off": _box("off") + b"\n"}]
    if form == "NPZ":
        return [{"a.npz": _npz()}]
    raise ValueError(form)


FORMATS = ("GLB", "OBJ", "PLY", "STL", "OFF", "NPZ")
COUNTED = {"GLB", "PLY", "STL", "OFF", "NPZ"}  # formats that say how much they hold


# Mutations: each takes bytes and gives others


def flip(data: bytearray, rng: np.random.Generator) -> None:
    """Bits turned."""
    for _ in range(int(rng.integers(1, 9))):
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))


def cut(data: bytearray, rng: np.random.Generator) -> None:
    """The end lost."""
    del data[int(rng.integers(len(data))) :]


def take_out(data: bytearray, rng: np.random.Generator) -> None:
    """A piece of the middle lost."""
    start = int(rng.integers(len(data)))
    del data[start : start + int(rng.integers(1, 200))]


def splice(data: bytearray, rng: np.random.Generator) -> None:
    """A piece of the file put in at another place."""
    start, length, to = int(rng.integers(len(data))), int(rng.integers(1, 200)), int(rng.integers(len(data)))
    data[to:to] = data[start : start + length]


def overwrite(data: bytearray, rng: np.random.Generator) -> None:
    """A piece replaced by noise, or by the bytes of something else."""
    start, length = int(rng.integers(len(data))), int(rng.integers(1, 60))
    data[start : start + length] = rng.bytes(length) if rng.random() < 0.5 else b"<html>\x00\xff PK\x03\x04" * 4


def numbers(data: bytearray, rng: np.random.Generator) -> None:
    """Numbers as text exchanged for others, or for what is none."""
    for _ in range(int(rng.integers(1, 4))):
        found = list(NUMBER.finditer(bytes(data)))
        if found:
            at = found[int(rng.integers(len(found)))].span()
            data[at[0] : at[1]] = EVIL[int(rng.integers(len(EVIL)))]


def words(data: bytearray, rng: np.random.Generator) -> None:
    """Four bytes exchanged for a number that somebody trusts."""
    for _ in range(int(rng.integers(1, 3))):
        at = 4 * int(rng.integers(max(1, len(data) // 4))) + int(rng.integers(2)) * int(rng.integers(4))
        data[at : at + 4] = struct.pack("<I", WORDS[int(rng.integers(len(WORDS)))])


def lines(data: bytearray, rng: np.random.Generator) -> None:
    """Lines lost, doubled or exchanged."""
    parts = bytes(data).splitlines(keepends=True)
    if len(parts) > 2:
        a, b = (int(k) for k in rng.integers(0, len(parts), 2))
        how = rng.integers(3)
        if how == 0:
            del parts[a]
        elif how == 1:
            parts.insert(a, parts[b])
        else:
            parts[a], parts[b] = parts[b], parts[a]
        data[:] = b"".join(parts)


def document(data: bytearray, rng: np.random.Generator) -> None:
    """The JSON of a GLB with a value exchanged for another kind, its lengths put right again."""
    try:
        size = struct.unpack_from("<I", data, 12)[0]
        tree, rest = json.loads(bytes(data[20 : 20 + size])), bytes(data[20 + size :])
    except (struct.error, ValueError):  # no GLB, or damaged already
        numbers(data, rng)
        return
    for _ in range(int(rng.integers(1, 4))):
        places = list(_places(tree)) or [([0], 0)]
        holder, key = places[int(rng.integers(len(places)))]
        values = [0, -1, 1, 7, 2**31, 2**53, 1e38, 1e308, -1e300, "x", "../x", None, [], {}, True, [[[]]], holder]
        value = values[int(rng.integers(len(values)))]
        holder[key] = json.loads(json.dumps(value))
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    data[:] = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest


def _places(tree: object):
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield tree, key
        yield from _places(value)


def inside(data: bytearray, rng: np.random.Generator) -> None:
    """Numbers in the arrays and the header of an archive, all its checksums right."""
    try:
        with np.load(io.BytesIO(bytes(data))) as file:
            arrays = {name: file[name].copy() for name in file.files}
        tree = json.loads(bytes(arrays["header"]))
    except Exception:  # no archive, or damaged already
        words(data, rng)
        return
    for _ in range(int(rng.integers(1, 4))):
        name = list(arrays)[int(rng.integers(len(arrays)))]
        flat = arrays[name].reshape(-1)
        if rng.random() < 0.3 or name == "header" or not flat.size:
            places = list(_places(tree))
            holder, key = places[int(rng.integers(len(places)))]
            holder[key] = [0, -1, 3, 1e300, "x", None, [], {}, True][int(rng.integers(9))]
        elif rng.random() < 0.2:
            arrays[name] = arrays[name][: len(arrays[name]) // 2]
        else:
            values = np.array([0, -1, 1, 2**31 - 1, 1e300, np.nan, -0.5])
            with np.errstate(all="ignore"):
                flat[int(rng.integers(flat.size))] = values[int(rng.integers(len(values)))].astype(flat.dtype)
    arrays["header"] = np.frombuffer(json.dumps(tree).encode(), np.uint8)
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    data[:] = stream.getvalue()


def mended(data: bytearray) -> None:
    """The lengths in a GLB put right, so that the damage is met further in."""
    at = data.find(b"BIN\0", 20)
    if data[:4] == b"glTF" and at > 24:
        struct.pack_into("<II", data, 8, len(data), at - 24)
        struct.pack_into("<I", data, at - 4, len(data) - at - 4)


MUTATIONS = (flip, cut, take_out, splice, overwrite, numbers, words, lines, document)


def mutant(form: str, number: int, whole: list[Files]) -> tuple[Files, Files, str]:
    """The whole files, the damaged ones, and what was done."""
    rng = np.random.default_rng([number, FORMATS.index(form)])
    files = whole[int(rng.integers(len(whole)))]
    name = list(files)[int(rng.integers(len(files)) * (rng.random() < 0.4))]
    data = bytearray(files[name])
    done = []
    for _ in range(1 if rng.random() < 0.7 else 2):
        mutation = MUTATIONS[int(rng.integers(len(MUTATIONS)))]
        if form in ("NPZ", "GLB") and rng.random() < 0.5:
            mutation = inside if form == "NPZ" else document
        mutation(data, rng)
        done.append(mutation.__name__)
        if not data:
            break
    if data and bytes(data) == files[name]:  # lines of a binary file, numbers of a file without any
        flip(data, rng)
        done.append("flip")
    if form == "GLB" and rng.random() < 0.7:
        mended(data)
        done.append("mended")
    return files, {**files, name: bytes(data)}, f"{name}: {' + '.join(done)}"


# Reading


def read(files: Files, folder: Path, deep: bool = False) -> tuple[object, list[str]]:
    """What a reader gives, reduced to plain bytes, and the warnings it gave; `deep`: it is cut into patches too."""
    for name, content in files.items():
        (folder / name).write_bytes(content)
    path = folder / next(iter(files))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if path.suffix == ".npz":
            solution = rad.read_solution(path)
            return (_plain(solution.scene), solution.radiosity.tobytes(), solution.factors.matrix.data.tobytes()), []
        scene = rad.read_scene(path)
        if deep:
            with contextlib.suppress(RadiosityError):  # of its geometry, which speaks of surfaces
                rad.subdivide(scene)
                scene.validate()
    foreign = [str(w.message) for w in caught if not issubclass(w.category, rad.RadiosityWarning)]
    if foreign:
        raise RuntimeWarning(foreign[0])
    return _plain(scene), sorted(str(w.message) for w in caught)


def _plain(scene: rad.Scene) -> object:
    return [
        (
            s.name,
            s.vertices.tobytes(),
            s.faces.tobytes(),
            s.material.reflectance.tobytes(),
            s.material.emission.tobytes(),
        )
        for s in scene.surfaces
    ]


def must_show(form: str, whole: Files, damaged: Files, done: str) -> bool:
    """Whether a count, a size or a checksum of the format can show the damage: the file has lost or gained bytes."""
    if "mended" in done or "inside" in done:
        return False
    name = next(iter(whole))
    before, after = whole[name], damaged[name]
    if form == "NPZ":
        return before != after
    if form == "OBJ":  # nothing is counted, but a line without an end is a sign
        return before.startswith(after) and not after.endswith((b"\n", b"\r")) and len(after) < len(before)
    if form in ("GLB", "STL") and b"facet" not in before:
        return len(before) != len(after) and after[:12] == before[:12] and after[80:84] == before[80:84]
    return len(after) < len(before) and before.startswith(after)


def outcome(form: str, number: int, whole: list[Files], folder: Path, deep: bool) -> tuple[str, str]:
    """What a mutant came to, in a word, and the details."""
    original, damaged, done = mutant(form, number, whole)
    label = f"{form} {number} ({done})"
    expected = _expected(original, folder)
    signal.signal(signal.SIGALRM, _alarm)
    signal.alarm(SECONDS)
    try:
        found, said = read(damaged, folder, deep)
    except RadiosityError as error:
        text = str(error)
        if next(iter(damaged)) not in text:
            return "unplaced", f"{label}: {text}"
        return "refused", ""
    except Hang:
        return "hang", label
    except BaseException as error:
        return "foreign", f"{label}: {type(error).__name__}: {error}"
    finally:
        signal.alarm(0)
    if found == expected[0]:
        return "same", ""
    if must_show(form, original, damaged, done) and set(said) <= set(expected[1]):
        return "silent", label
    return "read", ""


_KNOWN: dict[bytes, tuple[object, list[str]]] = {}


def _expected(files: Files, folder: Path) -> tuple[object, list[str]]:
    key = b"".join(files.values())
    if key not in _KNOWN:
        _KNOWN[key] = read(files, folder)
    return _KNOWN[key]


def _alarm(*_: object) -> None:
    raise Hang


def run(form: str, count: int, deep: bool = False) -> dict[str, object]:
    """Read the first mutants of a format."""
    whole = seeds(form)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for files in whole:
            _expected(files, folder)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + BYTES, resource.RLIM_INFINITY))
        tally: Counter[str] = Counter()
        trouble, slowest = [], 0.0
        for number in range(count):
            faulthandler.dump_traceback_later(6 * SECONDS, exit=True)
            began = time.perf_counter()
            kind, details = outcome(form, number, whole, folder, deep)
            slowest = max(slowest, time.perf_counter() - began)
            tally[kind] += 1
            if details:
                trouble.append(f"{kind}: {details}")
        faulthandler.cancel_dump_traceback_later()
    return {"format": form, "mutants": count, "slowest": round(slowest, 2), "tally": dict(tally), "trouble": trouble}


if __name__ == "__main__":
    wanted = FORMATS if sys.argv[1] == "all" else (sys.argv[1],)
    for one in wanted:
        sys.stdout.write(json.dumps(run(one, int(sys.argv[2]), "deep" in sys.argv)) + "\n")
        sys.stdout.flush()
