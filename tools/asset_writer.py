"""What make_assets.py builds models with: vectors, grids of vertices, glTF, PNG, the audit."""
import json
import math
import os
import struct
import zlib

FLOAT, U8, U16, U32 = 5126, 5121, 5123, 5125
POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN = range(7)


# Small vectors ---------------------------------------------------------------------------------

def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(a, s):
    return tuple(x * s for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def bezier(points, t):
    """A Bezier curve of any degree, by de Casteljau's scheme."""
    while len(points) > 1:
        points = [mix(a, b, t) for a, b in zip(points, points[1:])]
    return points[0]


def smoothstep(low, high, x):
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def turn(k, n):
    """(cos, sin) of k/n of a full turn, exactly 0 and 1 where they should be."""
    angle = 2.0 * math.pi * k / n
    return tuple(0.0 if abs(x) < 1e-12 else x for x in (math.cos(angle), math.sin(angle)))


def float32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


# glTF ------------------------------------------------------------------------------------------

class Primitive:
    """Vertices and triangles of one primitive; positions keep the sign of their zeros."""

    def __init__(self, material=None, mode=TRIANGLES, index_type=U16):
        self.material, self.mode, self.index_type = material, mode, index_type
        self.positions, self.normals, self.uvs, self.colors, self.indices = [], [], [], [], []
        self.influences = []  # of every vertex or none: up to four pairs of a joint and a weight
        self.targets = []  # morph targets: what each adds to positions and to normals

    def vertex(self, position, normal=None, uv=None, color=None):
        self.positions.append(tuple(float32(x) for x in position))
        for values, value in ((self.normals, normal), (self.uvs, uv), (self.colors, color)):
            if value is not None:
                values.append(tuple(float32(x) for x in value))
        return len(self.positions) - 1

    def triangle(self, *corners):
        self.indices.extend(corners)

    def face(self, *points, uvs=None, color=None):
        """A flat convex face with vertices of its own and its geometric normal."""
        normal = unit(cross(sub(points[1], points[0]), sub(points[2], points[0])))
        uvs = uvs or [None] * len(points)
        corners = [self.vertex(p, normal, uv, color) for p, uv in zip(points, uvs)]
        for k in range(1, len(corners) - 1):
            self.triangle(corners[0], corners[k], corners[k + 1])

    def triangles(self):
        """Corner indices of every triangle, strips and fans unrolled as glTF defines them."""
        i = self.indices or list(range(len(self.positions)))
        if self.mode == TRIANGLES:
            return [tuple(i[k:k + 3]) for k in range(0, len(i), 3)]
        if self.mode == STRIP:
            return [(i[k], i[k + 1 + k % 2], i[k + 2 - k % 2]) for k in range(len(i) - 2)]
        if self.mode == FAN:
            return [(i[k + 1], i[k + 2], i[0]) for k in range(len(i) - 2)]
        return []


class Gltf:
    def __init__(self):
        self.binary = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "girih make_assets.py",
                               "copyright": "girih contributors, MIT"},
                     "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": []}
        self.meshes = []

    def append(self, kind, item):
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    def view(self, data, target=None):
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.binary.extend(data)
        return self.append("bufferViews", view)

    def attribute(self, values, bounds=False, target=34962, component=FLOAT):
        flat = [x for value in values for x in value]
        data = struct.pack("<%d%s" % (len(flat), "B" if component == U8 else "f"), *flat)
        accessor = {"bufferView": self.view(data, target),
                    "componentType": component, "count": len(values),
                    "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[len(values[0])]}
        if bounds:
            columns = list(zip(*values))
            # Plus zero: a bound of -0 would read "-0.0" for nothing.
            accessor["min"] = [min(column) + 0.0 for column in columns]
            accessor["max"] = [max(column) + 0.0 for column in columns]
        return self.append("accessors", accessor)

    def mesh(self, name, *primitives):
        written = []
        for p in primitives:
            attributes = {"POSITION": self.attribute(p.positions, True)}
            for semantic, values in (("NORMAL", p.normals), ("TEXCOORD_0", p.uvs),
                                     ("COLOR_0", p.colors)):
                if values:
                    assert len(values) == len(p.positions), (name, semantic)
                    attributes[semantic] = self.attribute(values)
            if p.influences:
                padded = [(i + [(0, 0.0)] * 4)[:4] for i in p.influences]
                attributes["JOINTS_0"] = self.attribute([[j for j, _ in i] for i in padded],
                                                        component=U8)
                attributes["WEIGHTS_0"] = self.attribute([[w for _, w in i] for i in padded])
            item = {"attributes": attributes, "mode": p.mode}
            if p.targets:
                item["targets"] = [{"POSITION": self.attribute(moves, True),
                                    "NORMAL": self.attribute(turns)} for moves, turns in p.targets]
            if p.indices:
                code = {U8: "B", U16: "H", U32: "I"}[p.index_type]
                data = struct.pack("<%d%s" % (len(p.indices), code), *p.indices)
                item["indices"] = self.append("accessors", {
                    "bufferView": self.view(data, 34963), "componentType": p.index_type,
                    "count": len(p.indices), "type": "SCALAR"})
            if p.material is not None:
                item["material"] = p.material
            written.append(item)
        self.meshes.append((name, primitives))
        return self.append("meshes", {"name": name, "primitives": written})

    def node(self, name, mesh=None, children=None, root=True, **rest):
        node = {"name": name, **rest}
        if mesh is not None:
            node["mesh"] = mesh
        if children:
            node["children"] = children
        index = self.append("nodes", node)
        if root:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def skin(self, joints, origins):
        """A skin whose joints stand, unturned, at these points when it is bound."""
        matrices = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1) for x, y, z in origins]
        return self.append("skins", {"joints": joints, "inverseBindMatrices":
                                     self.attribute(matrices, target=None)})

    def animation(self, name, *channels):
        """Channels of (node, path, interpolation, times, values)."""
        animation = {"name": name, "channels": [], "samplers": []}
        for node, path, interpolation, times, values in channels:
            animation["channels"].append({"sampler": len(animation["samplers"]),
                                          "target": {"node": node, "path": path}})
            animation["samplers"].append({
                "input": self.attribute([(t,) for t in times], True, target=None),
                "output": self.attribute(values, target=None), "interpolation": interpolation})
        return self.append("animations", animation)

    def material(self, name, srgb, alpha=1.0, metallic=0.0, roughness=0.6, **rest):
        """A material whose base colour is given in sRGB, 0..255."""
        linear = [float32(round(((c / 255 + 0.055) / 1.055) ** 2.4 if c > 10 else c / 3294.6, 6))
                  for c in srgb]
        pbr = {"baseColorFactor": linear + [alpha],
               "metallicFactor": metallic, "roughnessFactor": roughness}
        if "texture" in rest:
            pbr["baseColorTexture"] = {"index": rest.pop("texture")}
        return self.append("materials", {"name": name, "pbrMetallicRoughness": pbr, **rest})

    def texture(self, name, png):
        image = self.append("images", {"name": name, "mimeType": "image/png",
                                       "bufferView": self.view(png)})
        sampler = self.append("samplers", {"magFilter": 9729, "minFilter": 9987,
                                           "wrapS": 10497, "wrapT": 33071})
        return self.append("textures", {"source": image, "sampler": sampler})

    def write(self, folder, name):
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        with open(os.path.join(folder, name), "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)
        print("%s: %d bytes" % (name, 28 + len(text) + len(binary)))
        for mesh, primitives in self.meshes:
            counts = "  ".join("%s %d" % count for count in audit(primitives).items())
            print("    %-20s %s" % (mesh, counts))

    def expect(self, **expected):
        """Every mesh is audited: closed and clean unless expected says otherwise."""
        for name, primitives in self.meshes:
            counts = audit(primitives)
            del counts["triangles"]
            want = {**dict.fromkeys(counts, 0), **expected.get(name, {})}
            assert counts == want, (name, counts, want)


def audit(primitives):
    """Counts by exact position, -0 taken as +0. Triangles with two equal corners have no edges."""
    edges, count, degenerate, slivers = {}, 0, 0, 0
    for primitive in primitives:
        for corners in primitive.triangles():
            p = [tuple(x + 0.0 for x in primitive.positions[c]) for c in corners]
            count += 1
            if len(set(p)) < 3:
                degenerate += 1
                continue
            slivers += not any(cross(sub(p[1], p[0]), sub(p[2], p[0])))
            for k in range(3):
                a, b = p[k], p[(k + 1) % 3]
                edges.setdefault((min(a, b), max(a, b)), []).append(a < b)
    return {"triangles": count, "degenerate": degenerate, "slivers": slivers,
            "open": sum(len(e) == 1 for e in edges.values()),
            "nonmanifold": sum(len(e) > 2 for e in edges.values()),
            "flipped": sum(len(e) == 2 and e[0] == e[1] for e in edges.values())}


def grid(primitive, rows):
    """Joins rows of (position, normal, uv), bottom to top, each from left to right seen from
    outside. A row whose positions are all one point is a pole: one triangle a column there."""
    first = len(primitive.indices)
    indices = [[primitive.vertex(*v) for v in row] for row in rows]
    poles = [len({v[0] for v in row}) == 1 for row in rows]
    for j in range(len(rows) - 1):
        for k in range(len(rows[j]) - 1):
            a, b, c, d = (indices[j][k], indices[j][k + 1], indices[j + 1][k + 1],
                          indices[j + 1][k])
            if not poles[j]:
                primitive.triangle(a, b, c if not poles[j + 1] else d)
            if not poles[j + 1]:
                primitive.triangle(a, c, d)
    for k in range(first, len(primitive.indices), 3):
        a, b, c = primitive.indices[k:k + 3]
        p, normals = primitive.positions, primitive.normals
        face = cross(sub(p[b], p[a]), sub(p[c], p[a]))
        assert all(dot(face, normals[v]) > 0 for v in (a, b, c)), "normals point against the face"


def close_row(row, n, v, pole=False):
    """Adds texture coordinates and the seam's second column, position and normal bit by bit."""
    row = row + row[:1]
    return [(p, normal, ((k + 0.5 * pole) / n, v)) for k, (p, normal) in enumerate(row)]


def lathe_row(n, r, y, normal, v):
    """A ring around the y axis that starts at the back; normal is (radial, up)."""
    nr, ny = unit(normal)
    row = []
    for k in range(n):
        c, s = turn(k, n)
        row.append(((-r * s + 0.0, y, -r * c + 0.0), (-nr * s + 0.0, ny, -nr * c + 0.0)))
    return close_row(row, n, v, r == 0.0)


def lathe(primitive, n, *pieces):
    """Pieces of profile rows (r, y, normal, v); between pieces lies a hard edge."""
    for piece in pieces:
        grid(primitive, [lathe_row(n, *row) for row in piece])


def profile(curve, samples, v):
    """Rows along a Bezier profile, normals from its tangent; v maps a sample to its texture v."""
    rows = []
    for t in samples:
        h = 1e-4
        a, b = bezier(curve, max(t - h, 0.0)), bezier(curve, min(t + h, 1.0))
        r, y = bezier(curve, t)
        rows.append((r, y, (b[1] - a[1], a[0] - b[0]), v(t)))
    return rows


def sweep(primitive, n, samples, surface, v):
    """A tube: surface(angle cosine, angle sine, t) to a point; normals by central differences."""
    rows = []
    for t in samples:
        row = []
        for k in range(n):
            c, s = turn(-k, n)
            h = 1e-4
            around = sub(surface(c + s * h, s - c * h, t), surface(c - s * h, s + c * h, t))
            along = sub(surface(c, s, t + h), surface(c, s, t - h))
            row.append((surface(c, s, t), unit(cross(around, along))))
        rows.append(close_row(row, n, v(t)))
    grid(primitive, rows)
    return rows


def cap(primitive, row, last):
    """Closes the first or last row of a tube with a flat fan, its rim a hard edge."""
    n = len(row) - 1
    normal = (0.0, 0.0, 0.0)
    for (p, _, _), (q, _, _) in zip(row, row[1:]):
        normal = add(normal, cross(p, q))
    normal = unit(scale(normal, 1.0 if last else -1.0))
    ring = [(p, normal, uv) for p, _, uv in row]
    center = scale(tuple(map(sum, zip(*(p for p, _, _ in row[:-1])))), 1.0 / n)
    middle = [(center, normal, ((k + 0.5) / n, uv[1])) for k, (_, _, uv) in enumerate(ring)]
    grid(primitive, [ring, middle] if last else [middle, ring])


def png(width, height, pixels):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    channels = len(pixels[0])
    lines = b"".join(b"\0" + bytes(c for p in pixels[y * width:(y + 1) * width] for c in p)
                     for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
            + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b""))
