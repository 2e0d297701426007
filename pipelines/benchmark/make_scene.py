"""Makes the benchmark's generated scenes as binary PLY; the same arguments give the same bytes.

    make_scene.py OUT.ply slivers COUNT          random slivers in the unit cube
    make_scene.py OUT.ply scatter COUNT MODEL    copies of a model on a floor of two triangles
    make_scene.py OUT.ply split MODEL            each triangle split in four
    make_scene.py OUT.ply stadium MODEL          a model in a box of ten triangles, a hundred times as long

Models are OBJ or PLY (ASCII or binary little-endian); positions and faces are read, nothing else.
"""
import array
import math
import pathlib
import random
import struct
import sys

SLIVER_LENGTH = 0.2
SLIVER_HEIGHT = 0.001
STADIUM_SIDE = 100  # of the model's
FORMATS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
FORMATS |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"}
FORMATS |= {"float32": "f", "float64": "d"}


def write_ply(path, vertices, triangles):
    """vertices: flat x, y, z; triangles: flat indices, three each."""
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices) // 3}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles) // 3}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    face = struct.Struct("<B3i")
    faces = bytearray(face.size * (len(triangles) // 3))
    for i in range(0, len(triangles), 3):
        face.pack_into(faces, i // 3 * face.size, 3, *triangles[i : i + 3])
    with open(path, "wb") as out:
        out.write(head.encode())
        out.write(struct.pack(f"<{len(vertices)}f", *vertices))
        out.write(faces)


def read_header(file):
    """The format and [(element, count, [property declaration, ...]), ...]."""
    kind, elements = None, []
    for line in file:
        words = line.decode("ascii").split()
        if words[0] == "format":
            kind = words[1]
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
        elif words[0] == "end_header":
            return kind, elements
    raise ValueError("no end_header")


def read_binary_rows(file, count, properties):
    for _ in range(count):
        row = []
        for declaration in properties:
            repeat = 1
            if declaration[0] == "list":
                size = FORMATS[declaration[1]]
                (repeat,) = struct.unpack("<" + size, file.read(struct.calcsize(size)))
                row.append(repeat)
            value = f"<{repeat}{FORMATS[declaration[-2]]}"
            row.extend(struct.unpack(value, file.read(struct.calcsize(value))))
        yield row


def read_ply(path):
    """Vertices and triangles, flat; polygons become fans. Positions come first in the vertices."""
    vertices, triangles = array.array("f"), array.array("i")
    with open(path, "rb") as file:
        kind, elements = read_header(file)
        if kind not in ("ascii", "binary_little_endian"):
            raise ValueError(f"{path}: {kind} PLY is not read here")
        for name, count, properties in elements:
            if kind == "ascii":
                rows = ([float(w) for w in file.readline().split()] for _ in range(count))
            else:
                rows = read_binary_rows(file, count, properties)
            for row in rows:
                if name == "vertex":
                    vertices.extend(row[:3])
                elif name == "face":
                    add_fan(triangles, [int(i) for i in row[1 : 1 + int(row[0])]])
    return vertices, triangles


def read_obj(path):
    vertices, triangles = array.array("f"), array.array("i")
    with open(path, encoding="ascii", errors="replace") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                vertices.extend(float(w) for w in words[1:4])
            elif words[0] == "f":
                corners = [int(w.split("/")[0]) for w in words[1:]]
                add_fan(triangles, [i - 1 if i > 0 else len(vertices) // 3 + i for i in corners])
    return vertices, triangles


def add_fan(triangles, corners):
    for b, c in zip(corners[1:], corners[2:]):
        triangles.extend((corners[0], b, c))


def read_model(path):
    return read_obj(path) if pathlib.Path(path).suffix == ".obj" else read_ply(path)


def random_direction(rng):
    while True:
        d = [2.0 * rng.random() - 1.0 for _ in range(3)]
        length = math.hypot(*d)
        if 1e-3 < length <= 1.0:
            return [x / length for x in d]


def make_slivers(count):
    """Triangles of length 0.2 and height 0.001, their centres anywhere in the unit cube."""
    rng = random.Random(1)
    vertices = array.array("f")
    for _ in range(count):
        centre = [rng.random() for _ in range(3)]
        along, other = random_direction(rng), random_direction(rng)
        across = [
            along[1] * other[2] - along[2] * other[1],
            along[2] * other[0] - along[0] * other[2],
            along[0] * other[1] - along[1] * other[0],
        ]
        height = SLIVER_HEIGHT / max(math.hypot(*across), 1e-6)
        for end, up in ((-0.5 * SLIVER_LENGTH, 0.0), (0.5 * SLIVER_LENGTH, 0.0), (0.0, height)):
            vertices.extend(c + a * end + x * up for c, a, x in zip(centre, along, across))
    return vertices, array.array("i", range(3 * count))


def make_scatter(count, model):
    """Copies of a model, turned about y, on the cells of a square of floor, each somewhere in its cell."""
    vertices, triangles = read_model(model)
    lo = [min(vertices[axis::3]) for axis in range(3)]
    hi = [max(vertices[axis::3]) for axis in range(3)]
    middle = [0.5 * (a + b) for a, b in zip(lo, hi)]
    cell = 1.3 * math.hypot(hi[0] - lo[0], hi[2] - lo[2])
    side = math.ceil(math.sqrt(count))
    rng = random.Random(2)
    out, faces = array.array("f"), array.array("i")
    for copy in range(count):
        angle = 2.0 * math.pi * rng.random()
        cosine, sine = math.cos(angle), math.sin(angle)
        x0 = cell * (copy % side + 0.5 + 0.2 * (rng.random() - 0.5))
        z0 = cell * (copy // side + 0.5 + 0.2 * (rng.random() - 0.5))
        faces.extend(i + len(out) // 3 for i in triangles)
        for i in range(0, len(vertices), 3):
            x, z = vertices[i] - middle[0], vertices[i + 2] - middle[2]
            out.extend((x0 + cosine * x + sine * z, vertices[i + 1] - lo[1], z0 + cosine * z - sine * x))
    first, end = len(out) // 3, cell * side
    out.extend((0.0, 0.0, 0.0, 0.0, 0.0, end, end, 0.0, end, end, 0.0, 0.0))
    faces.extend(first + i for i in (0, 1, 2, 0, 2, 3))
    return out, faces


def make_stadium(model):
    """A model on the middle of a square floor with four walls a tenth as high, no roof."""
    vertices, triangles = read_model(model)
    lo = [min(vertices[axis::3]) for axis in range(3)]
    hi = [max(vertices[axis::3]) for axis in range(3)]
    middle = [0.5 * (lo[0] + hi[0]), lo[1], 0.5 * (lo[2] + hi[2])]
    out = array.array("f", (v - middle[i % 3] for i, v in enumerate(vertices)))
    first, half = len(out) // 3, STADIUM_SIDE / 2 * max(b - a for a, b in zip(lo, hi))
    for y in (0.0, 0.2 * half):
        for x, z in ((-half, -half), (half, -half), (half, half), (-half, half)):
            out.extend((x, y, z))
    quads = [(0, 1, 2, 3)] + [(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)]
    for quad in quads:
        add_fan(triangles, [first + corner for corner in quad])
    return out, triangles


def make_split(model):
    """Every triangle becomes four; triangles that share an edge share its middle."""
    vertices, triangles = read_model(model)
    middles, faces = {}, array.array("i")

    def middle(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in middles:
            middles[key] = len(vertices) // 3
            vertices.extend(0.5 * (vertices[3 * a + k] + vertices[3 * b + k]) for k in range(3))
        return middles[key]

    for i in range(0, len(triangles), 3):
        a, b, c = triangles[i : i + 3]
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        faces.extend((a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca))
    return vertices, faces


MAKERS = {"slivers": make_slivers, "scatter": make_scatter, "split": make_split, "stadium": make_stadium}


def make(path, kind, *arguments):
    write_ply(path, *MAKERS[kind](*(int(a) if a.isdigit() else a for a in arguments)))


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[2] not in MAKERS:
        sys.exit(__doc__.strip())
    make(*sys.argv[1:])
