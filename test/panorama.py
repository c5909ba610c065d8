#!/usr/bin/env python3
"""Models to look around in, and what holds for their panoramas. Needs nothing but Python.
Usage: panorama.py room FILE.gltf | ring TEAPOT.glb FILE.glb | covered PNG | closed PNG | turned PNG PNG COLUMNS PERMILLE |
corners PNG X Y Z"""
import base64
import json
import math
import struct
import sys
import zlib


SIZE = (3.0, 1.5, 4.0)  # of the room, half


def write_room(path):
    """A closed room of twelve triangles and a ball in it behind whoever looks along -z from the middle, unlit, seen from inside. Colours vary with the
    position; blue is 0 everywhere, which the background's never is."""
    positions, normals, colors, indices = [], [], [], []

    def vertex(position, normal):
        positions.append(position)
        normals.append(normal)
        colors.append((0.5 + 0.12 * position[0], 0.5 + 0.12 * position[2] + 0.05 * position[1], 0.0, 1.0))

    for axis in range(3):
        for side in (-1.0, 1.0):
            first = len(positions)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p, n = [0.0] * 3, [0.0] * 3
                p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, a * side, b
                n[axis] = -side
                vertex(tuple(x * s for x, s in zip(p, SIZE)), tuple(n))
            indices += [first + k for k in (0, 2, 1, 0, 3, 2)]
    first, columns, rows = len(positions), 12, 8
    for row in range(rows + 1):
        for column in range(columns + 1):
            a, b = 2.0 * math.pi * column / columns, math.pi * row / rows
            n = (math.sin(b) * math.cos(a), math.cos(b), math.sin(b) * math.sin(a))
            vertex(tuple(c + 0.4 * x for c, x in zip((0.1, -0.4, 2.2), n)), n)
    for row in range(rows):
        for column in range(columns):
            k = first + row * (columns + 1) + column
            indices += [k, k + 1, k + columns + 1] if row else []
            indices += [k + 1, k + columns + 2, k + columns + 1] if row < rows - 1 or row == 0 else []
    blocks = [b''.join(struct.pack('<%df' % len(v), *v) for v in values) for values in (positions, normals, colors)]
    blocks.append(struct.pack('<%dH' % len(indices), *indices))
    views, accessors, offset = [], [], 0
    kinds = ((5126, 'VEC3'), (5126, 'VEC3'), (5126, 'VEC4'), (5123, 'SCALAR'))
    for block, (kind, shape), values in zip(blocks, kinds, (positions, normals, colors, indices)):
        views.append({'buffer': 0, 'byteOffset': offset, 'byteLength': len(block)})
        accessors.append({'bufferView': len(views) - 1, 'componentType': kind, 'type': shape, 'count': len(values)})
        offset += len(block)
    accessors[0]['min'] = [min(p[n] for p in positions) for n in range(3)]
    accessors[0]['max'] = [max(p[n] for p in positions) for n in range(3)]
    data = base64.b64encode(b''.join(blocks)).decode()
    document = {
        'asset': {'version': '2.0'}, 'extensionsUsed': ['KHR_materials_unlit'],
        'scenes': [{'nodes': [0]}], 'scene': 0, 'nodes': [{'mesh': 0}],
        'materials': [{'extensions': {'KHR_materials_unlit': {}}}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0, 'NORMAL': 1, 'COLOR_0': 2}, 'indices': 3,
                                    'material': 0}]}],
        'accessors': accessors, 'bufferViews': views,
        'buffers': [{'byteLength': offset, 'uri': 'data:application/octet-stream;base64,' + data}]}
    with open(path, 'w') as file:
        json.dump(document, file)


def write_ring(source, path):
    """Twelve copies of a model in a ring of radius 5 around the origin, one of them where a panorama that looks along
    -z ends."""
    with open(source, 'rb') as file:
        data = file.read()
    size = struct.unpack_from('<I', data, 12)[0]
    document = json.loads(data[20:20 + size])
    roots = document['scenes'][document.get('scene', 0)]['nodes']
    nodes = document['nodes']
    ring = []
    for k in range(12):
        a = math.pi * k / 6
        # A node has one parent, so the model's own nodes are copied with what is below them.
        def copy(number):
            node = dict(nodes[number])
            node['children'] = [copy(child) for child in nodes[number].get('children', [])]
            if not node['children']:
                del node['children']
            nodes.append(node)
            return len(nodes) - 1
        children = [copy(root) for root in roots]
        nodes.append({'children': children, 'translation': [5 * math.sin(a), 0, 5 * math.cos(a)],
                      'rotation': [0, math.sin(a / 2 + 0.3 * k), 0, math.cos(a / 2 + 0.3 * k)]})
        ring.append(len(nodes) - 1)
    document['scenes'][document.get('scene', 0)]['nodes'] = ring
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    rest = data[20 + size:]
    with open(path, 'wb') as file:
        file.write(struct.pack('<4sIIII', b'glTF', 2, 20 + len(text) + len(rest), len(text), 0x4e4f534a) + text + rest)


def read_png(path, size=3):
    """Rows of pixels of an 8-bit RGB or RGBA PNG, 3 or 4 numbers each."""
    with open(path, 'rb') as file:
        data = file.read()
    at, packed = 8, b''
    while at < len(data):
        length, kind = struct.unpack_from('>I4s', data, at)
        if kind == b'IHDR':
            width, height, depth, color = struct.unpack_from('>IIBB', data, at + 8)
            assert depth == 8 and color in (2, 6)
        elif kind == b'IDAT':
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    channels = 4 if color == 6 else 3
    raw, rows, before, stride = zlib.decompress(packed), [], None, width * channels
    before = bytearray(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            a = line[x - channels] if x >= channels else 0
            b, c = before[x], before[x - channels] if x >= channels else 0
            if kind == 4:
                guess = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            else:
                guess = (0, a, b, (a + b) // 2)[kind]
            line[x] = (line[x] + guess) & 255
        rows.append([tuple(line[k:k + size]) for k in range(0, stride, channels)])
        before = line
    return rows


def difference(p, q):
    return max(abs(a - b) for a, b in zip(p, q))


def covered(path):
    bare = [(x, y) for y, row in enumerate(read_png(path)) for x, p in enumerate(row) if p[2] != 0]
    assert not bare, '%s: %d pixels show the background, the first at %s' % (path, len(bare), bare[0])


def closed(path):
    """The last column goes on in the first as each column goes on in the next: what differs by more than the colours'
    slope are edges of the model, and not more of them than elsewhere."""
    rows = read_png(path)
    width = len(rows[0])
    steps = [sum(difference(row[x], row[(x + 1) % width]) > 3 for row in rows) for x in range(width)]
    assert steps[-1] <= max(steps[-40:-1] + steps[:40]), '%s: %d of %d rows break where it closes' % (
        path, steps[-1], len(rows))


def turned(first, second, columns, permille):
    """The second is the first, `columns` columns to the left, but for so many pixels."""
    a, b = read_png(first), read_png(second)
    width, height = len(a[0]), len(a)
    differs = sum(difference(a[y][(x + columns) % width], b[y][x]) > 2 for y in range(height) for x in range(width))
    print('%d of %d pixels differ' % (differs, width * height))
    assert 1000 * differs <= permille * width * height, 'turning is not shifting'


def corners(path, x, y, z):
    """Where the room's walls meet, in normals' colours as seen from a point, looking along -z: across the picture by
    the angle, and up it by height over distance, pixels being square on the horizon."""
    rows = read_png(path)
    width, height = len(rows[0]), len(rows)
    per_radian = width / (2.0 * math.pi)
    found = [n for n in range(1, width) if difference(rows[height // 2][n], rows[height // 2][n - 1]) > 30]
    wanted = [width / 2 + per_radian * math.atan2(a * SIZE[0] - x, z - b * SIZE[2]) for a in (-1, 1) for b in (-1, 1)]
    for column in wanted:
        assert any(abs(n - column) <= 1.0 for n in found), 'no corner at column %.1f, but %s' % (column, found)
    for n in found:
        assert any(abs(n - column) <= 1.0 for column in wanted), 'a corner at column %d, not %s' % (n, wanted)
    middle = [row[width // 2] for row in rows]
    found = [n for n in range(1, height) if difference(middle[n], middle[n - 1]) > 30]
    wanted = [height / 2 - per_radian * (a * SIZE[1] - y) / (z + SIZE[2]) for a in (1, -1)]
    assert len(found) in (2, 3, 4) and all(any(abs(n - row) <= 1.0 for n in found) for row in wanted) and \
        all(any(abs(n - row) <= 1.0 for row in wanted) for n in found), 'rows %s, not %s' % (found, wanted)


if __name__ == '__main__':
    arguments = sys.argv[2:]
    if sys.argv[1] == 'turned':
        arguments[2:] = [int(number) for number in arguments[2:]]
    elif sys.argv[1] == 'corners':
        arguments[1:] = [float(number) for number in arguments[1:]]
    {'room': write_room, 'ring': write_ring, 'covered': covered, 'closed': closed,
     'turned': turned, 'corners': corners}[sys.argv[1]](*arguments)
