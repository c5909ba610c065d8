"""Models with everything that refinement must keep, and what must hold of the refined ones.

kept.py make               writes rich.gltf and rich.bin (skin, morph targets, animation and all else),
                           morphed.gltf (rich with its first morph target at weight 1) and plain.gltf
                           (the same triangles and nothing else)
kept.py check OUT          all of rich.gltf is in OUT, and seams have the same bits on both sides
kept.py compare OUT MORPHED  OUT with its first morph target at weight 1 is MORPHED
kept.py vertices OUT PLAIN   as many vertices, and the same positions in the same order
"""
import base64
import json
import math
import struct
import sys

FORMATS = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
COMPONENTS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4, 'MAT4': 16}


# --- Writing ---

class Document:
    def __init__(self):
        self.binary = b''
        self.json = {'asset': {'version': '2.0', 'extras': {'of': 'asset'}}, 'accessors': [], 'bufferViews': []}

    def view(self, data, **members):
        self.binary += b'\0' * (-len(self.binary) % 4)
        self.json['bufferViews'].append(
            {'buffer': 0, 'byteOffset': len(self.binary), 'byteLength': len(data), **members})
        self.binary += data
        return len(self.json['bufferViews']) - 1

    def accessor(self, elements, component_type, kind, normalized=False, stride=None, bounds=False, **members):
        size = struct.calcsize(FORMATS[component_type]) * COMPONENTS[kind]
        pad = (stride or size) - size
        data = b''.join(struct.pack('<%d%s' % (COMPONENTS[kind], FORMATS[component_type]), *element) + bytes(pad)
                        for element in elements)
        view = self.view(data, **({'byteStride': stride} if stride else {}))
        accessor = {'bufferView': view, 'componentType': component_type, 'count': len(elements), 'type': kind, **members}
        if normalized:
            accessor['normalized'] = True
        if bounds:
            accessor['min'] = [min(column) for column in zip(*elements)]
            accessor['max'] = [max(column) for column in zip(*elements)]
        self.json['accessors'].append(accessor)
        return len(self.json['accessors']) - 1

    def write(self, name):
        self.json['buffers'] = [{'byteLength': len(self.binary), 'uri': name + '.bin'}]
        with open(name + '.bin', 'wb') as file:
            file.write(self.binary)
        with open(name + '.gltf', 'w', encoding='utf-8') as file:
            json.dump(self.json, file)


def single(value):
    """A number as a float of 32 bits."""
    return struct.unpack('<f', struct.pack('<f', value))[0]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [single(x / length) for x in v]


def ring_mesh(columns, rows):
    """A tube along x from -1 to 1, its seam doubled; triangles of its first and its second half."""
    positions, normals, texcoords = [], [], []
    for column in range(columns + 1):
        angle = 2 * math.pi * (column % columns) / columns
        for row in range(rows + 1):
            x = 2 * row / rows - 1
            positions.append([single(x), single(math.cos(angle)), single(math.sin(angle))])
            normals.append(unit([0.25 * x, math.cos(angle), math.sin(angle)]))
            texcoords.append([column / columns, row / rows])
    halves = [[], []]
    for column in range(columns):
        for row in range(rows):
            a = column * (rows + 1) + row
            b, c, d = a + 1, a + rows + 1, a + rows + 2
            halves[2 * row // rows] += [[a, c, b], [b, c, d]]
    return positions, normals, texcoords, halves


def weights_of(x):
    """Of joints 1 to 8, in the two sets of the first half: linear in x, adding up to 1."""
    return [(0.5 + 0.25 * x) / 7] * 4 + [0.5 - 0.25 * x] + [(0.5 + 0.25 * x) / 7] * 3


ROWS = 4


def influences_of(row):
    """In the one set of the second half: between two rows, there are more than it can hold."""
    return {(3 * row + c) % 9: (0.4, 0.3, 0.2, 0.1)[c] for c in range(4)}


def influences_at(x):
    """All joints at x, where the surface is flat."""
    row = min(int((x + 1) / 2 * ROWS), ROWS - 1)
    t = (x + 1) / 2 * ROWS - row
    found = {}
    for joints, part in (influences_of(row), 1 - t), (influences_of(row + 1), t):
        for joint, weight in joints.items():
            found[joint] = found.get(joint, 0) + part * weight
    return found


def make():
    positions, normals, texcoords, halves = ring_mesh(7, ROWS)
    bent = [[p[0], single(p[1] * (1.5 + p[0] / 2)), single(p[2] + 0.25 * p[0])] for p in positions]
    bent_normals = [unit([n[0] - 0.3, n[1], n[2]]) for n in normals]
    subtract = lambda a, b: [[single(x - y) for x, y in zip(p, q)] for p, q in zip(a, b)]
    weights = [weights_of(p[0]) for p in positions]
    count = len(positions)

    rich = Document()
    base = {'POSITION': rich.accessor(positions, 5126, 'VEC3', bounds=True, name='the points', extras={'of': 'accessor'}),
            'NORMAL': rich.accessor(normals, 5126, 'VEC3')}
    skin = {}
    for n in range(2):
        joints = [[4 * n + 1 + c for c in range(4)] for _ in positions]
        skin['JOINTS_%d' % n] = rich.accessor(joints, 5121, 'VEC4')
        skin['WEIGHTS_%d' % n] = rich.accessor([w[4 * n:4 * n + 4] for w in weights], 5126, 'VEC4')
    first = dict(base, **skin)
    first['TEXCOORD_0'] = rich.accessor(texcoords, 5126, 'VEC2')
    first['TEXCOORD_1'] = rich.accessor([[int(65535 * v), int(65535 * u)] for u, v in texcoords], 5123, 'VEC2', True)
    first['COLOR_0'] = rich.accessor([[int(255 * u), int(255 * v), 9] for u, v in texcoords], 5121, 'VEC3', True, 4)
    first['TANGENT'] = rich.accessor([[1.0, 0.0, 0.0, -1.0]] * count, 5126, 'VEC4')
    second = dict(base)
    rows = [influences_of(n % (ROWS + 1)) for n in range(count)]
    second['JOINTS_0'] = rich.accessor([list(row) for row in rows], 5123, 'VEC4')
    second['WEIGHTS_0'] = rich.accessor([list(row.values()) for row in rows], 5126, 'VEC4')
    second['COLOR_0'] = rich.accessor([[u, v, 0.5, 1.0] for u, v in texcoords], 5126, 'VEC4')
    second['COLOR_1'] = rich.accessor([[v, u, 0.5] for u, v in texcoords], 5126, 'VEC3')
    second['_HEIGHT'] = rich.accessor([[p[1]] for p in positions], 5126, 'SCALAR')
    bend = {'POSITION': rich.accessor(subtract(bent, positions), 5126, 'VEC3', bounds=True),
            'NORMAL': rich.accessor(subtract(bent_normals, normals), 5126, 'VEC3')}
    lift = {'POSITION': rich.accessor([[0.0, single(0.5 * u), 0.0] for u, v in texcoords], 5126, 'VEC3', bounds=True)}
    fade = dict(lift, COLOR_0=rich.accessor([[v, -u, 0.0, 0.0] for u, v in texcoords], 5126, 'VEC4'))
    indices = [rich.accessor([[i] for t in half for i in t], 5123, 'SCALAR') for half in halves]
    dots = rich.accessor([[0, 0, 1], [1, 0, 0]], 5126, 'VEC3', bounds=True)
    times = rich.accessor([[0.0], [0.5], [2.0]], 5126, 'SCALAR', bounds=True)
    turns = rich.accessor([[0, 0, 0, 32767], [0, 0, 32767, 0], [0, 0, 0, 32767]], 5122, 'VEC4', True)
    morphing = rich.accessor([[v] for v in (0, 1, 1, 0, 0.5, 0.5)], 5126, 'SCALAR')
    one = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    matrices = rich.accessor([one[:12] + [float(j), 0, 0, 1] for j in range(9)], 5126, 'MAT4')
    moved = rich.accessor([[0, 0, 0], [4, 0, 0]], 5126, 'VEC3')
    variants = {'KHR_materials_variants': {'mappings': [{'material': 1, 'variants': [0]}]}}
    rich.json.update({
        'extensionsUsed': ['KHR_materials_variants', 'KHR_lights_punctual', 'KHR_materials_ior', 'EXT_mesh_gpu_instancing',
                           'EXT_made_up', 'EXT_mesh_features'],
        'extensions': {'KHR_materials_variants': {'variants': [{'name': 'night'}]},
                       'KHR_lights_punctual': {'lights': [{'type': 'point', 'name': 'lamp'}]},
                       'EXT_made_up': {'value': [1, 'two']}},
        'materials': [{'name': 'day', 'doubleSided': True, 'extensions': {'KHR_materials_ior': {'ior': 1.25}}},
                      {'name': 'night', 'extras': {'of': 'material'}}],
        'cameras': [{'type': 'perspective', 'name': 'eye', 'perspective': {'yfov': 1, 'znear': 0.1}}],
        'meshes': [{'name': 'tube', 'weights': [0.25, 0], 'extras': {'targetNames': ['bend', 'lift'], 'of': 'mesh'},
                    'primitives': [{'attributes': first, 'indices': indices[0], 'material': 0, 'extensions': dict(
                        variants, EXT_mesh_features={'featureIds': [{'featureCount': 2}]}),
                                    'targets': [bend, lift], 'extras': {'of': 'primitive'}},
                                   {'attributes': second, 'indices': indices[1], 'targets': [bend, fade]}]},
                   {'name': 'dots', 'primitives': [{'attributes': {'POSITION': dots}, 'mode': 0}]}],
        'skins': [{'name': 'bones', 'inverseBindMatrices': matrices, 'joints': list(range(2, 11))}],
        'animations': [{'name': 'turn', 'extras': {'of': 'animation'},
                        'channels': [{'sampler': 0, 'target': {'node': 3, 'path': 'rotation'}},
                                     {'sampler': 1, 'target': {'node': 0, 'path': 'weights'}}],
                        'samplers': [{'input': times, 'output': turns},
                                     {'input': times, 'output': morphing, 'interpolation': 'STEP'}]}],
        'nodes': [{'mesh': 0, 'skin': 0, 'name': 'body', 'weights': [0.5, 0.25]},
                  {'mesh': 1, 'name': 'dotted', 'extras': {'of': 'node'},
                   'extensions': {'EXT_mesh_gpu_instancing': {'attributes': {'TRANSLATION': moved}}}}]
        + [{'name': 'joint %d' % j} for j in range(9)]
        + [{'camera': 0, 'extensions': {'KHR_lights_punctual': {'light': 0}}}],
        'scenes': [{'name': 'stage', 'nodes': list(range(12)), 'extras': {'of': 'scene'}}],
        'scene': 0})
    rich.write('rich')

    for name, points, directions in ('plain', positions, normals), ('morphed', bent, bent_normals):
        other = Document()
        attributes = {'POSITION': other.accessor(points, 5126, 'VEC3', bounds=True),
                      'NORMAL': other.accessor(directions, 5126, 'VEC3')}
        parts = [other.accessor([[i] for t in half for i in t], 5123, 'SCALAR') for half in halves]
        other.json['meshes'] = [{'primitives': [{'attributes': attributes, 'indices': part} for part in parts]}]
        other.json['nodes'] = [{'mesh': 0}]
        other.json['scenes'] = [{'nodes': [0]}]
        other.write(name)


# --- Reading ---

class Model:
    def __init__(self, path):
        with open(path, 'rb') as file:
            data = file.read()
        if data[:4] == b'glTF':
            size = struct.unpack_from('<I', data, 12)[0]
            self.json = json.loads(data[20:20 + size])
            self.binary = data[28 + size:]
        else:
            self.json = json.loads(data)
            with open(self.json['buffers'][0]['uri'], 'rb') as file:
                self.binary = file.read()

    def values(self, index):
        accessor = self.json['accessors'][index]
        view = self.json['bufferViews'][accessor['bufferView']]
        form = '<%d%s' % (COMPONENTS[accessor['type']], FORMATS[accessor['componentType']])
        stride = view.get('byteStride', struct.calcsize(form))
        start = view.get('byteOffset', 0) + accessor.get('byteOffset', 0)
        return [struct.unpack_from(form, self.binary, start + n * stride) for n in range(accessor['count'])]

    def primitives(self):
        for mesh in self.json['meshes']:
            for primitive in mesh['primitives']:
                if primitive.get('mode', 4) >= 4:
                    yield primitive


def near(a, b, tolerance, what):
    worst = max((abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q)), default=0)
    assert len(a) == len(b) and worst <= tolerance, '%s: off by %g' % (what, worst)


def without_bytes(value):
    """A document without what tells of bytes, and without what had to go."""
    if isinstance(value, list):
        return [without_bytes(element) for element in value]
    if not isinstance(value, dict):
        return value
    left_out = {'accessors', 'bufferViews', 'buffers', 'attributes', 'indices', 'targets', 'input', 'output',
                'inverseBindMatrices', 'extensionsUsed', 'EXT_mesh_features', 'generator'}
    return {name: without_bytes(member) for name, member in value.items() if name not in left_out}


def check_document(out, rich):
    assert without_bytes(out.json) == without_bytes(rich.json), 'the document is another'
    used = set(rich.json['extensionsUsed']) - {'EXT_mesh_features'}
    assert set(out.json['extensionsUsed']) == used, out.json['extensionsUsed']
    points = out.json['accessors'][out.json['meshes'][0]['primitives'][0]['attributes']['POSITION']]
    assert points['name'] == 'the points' and points['extras'] == {'of': 'accessor'}
    same = [lambda o: o['skins'][0]['inverseBindMatrices'],
            lambda o: o['meshes'][1]['primitives'][0]['attributes']['POSITION'],
            lambda o: o['nodes'][1]['extensions']['EXT_mesh_gpu_instancing']['attributes']['TRANSLATION']]
    for n in range(2):
        same.append(lambda o, n=n: o['animations'][0]['samplers'][n]['input'])
        same.append(lambda o, n=n: o['animations'][0]['samplers'][n]['output'])
    for find in same:
        assert out.values(find(out.json)) == rich.values(find(rich.json)), 'other values'
    for after, before in zip(out.primitives(), rich.primitives()):
        for a, b in [(after['attributes'], before['attributes'])] + list(zip(after['targets'], before['targets'])):
            assert set(a) == set(b), (set(a), set(b))
            for name in a:
                assert out.json['accessors'][a[name]]['type'] == rich.json['accessors'][b[name]]['type'], name


def check_weights(half, x, joints, weights):
    """Against the ones that are known of a flat surface."""
    found = dict(zip(joints, weights))
    if half == 0:
        near([[found.get(j + 1, 0) for j in range(8)]], [weights_of(x)], 1e-6, 'weights')
        return
    every = influences_at(x)
    kept = sorted(every.values(), reverse=True)[:4]
    near([weights], [([w / sum(kept) for w in kept] + [0] * 3)[:4]], 1e-6, 'the largest weights')
    for joint, weight in found.items():
        assert weight == 0 or abs(weight - every[joint] / sum(kept)) < 1e-6, 'a weight of another joint'


def check(path):
    out, rich = Model(path), Model('rich.gltf')
    check_document(out, rich)
    for half, primitive in enumerate(out.primitives()):
        at_point = {}
        attributes = {name: out.values(index) for name, index in primitive['attributes'].items()}
        deltas = [{name: out.values(index) for name, index in target.items()} for target in primitive['targets']]
        used = sorted({index for (index,) in out.values(primitive['indices'])})
        assert used == list(range(len(attributes['POSITION'])))
        for v in used:
            key = struct.pack('<3f', *(x + 0.0 for x in attributes['POSITION'][v]))
            joints, weights = [sum((attributes['%s_%d' % (name, n)][v] for n in range(2 - half)), ())
                               for name in ('JOINTS', 'WEIGHTS')]
            follows = (joints, weights, deltas[0]['POSITION'][v])
            assert at_point.setdefault(key, follows) == follows, 'the two sides of an edge come apart'
            assert abs(sum(weights) - 1) < 1e-6 and list(weights) == sorted(weights, reverse=True)
            if '--flat' in sys.argv:
                check_weights(half, attributes['POSITION'][v][0], joints, weights)
    near(out.values(next(out.primitives())['attributes']['TANGENT']),
         [[1, 0, 0, -1]] * len(out.values(next(out.primitives())['attributes']['TANGENT'])), 1e-6, 'tangents')


def compare(path, morphed_path):
    out, morphed = Model(path), Model(morphed_path)
    for a, b in zip(out.primitives(), morphed.primitives()):
        for name in 'POSITION', 'NORMAL':
            base = out.values(a['attributes'][name])
            delta = out.values(a['targets'][0][name])
            moved = [[x + y for x, y in zip(p, d)] for p, d in zip(base, delta)]
            near(moved, morphed.values(b['attributes'][name]), 1e-6, name)


def vertices(path, plain_path):
    out, plain = Model(path), Model(plain_path)
    for a, b in zip(out.primitives(), plain.primitives()):
        assert sorted(out.values(a['attributes']['POSITION'])) == sorted(plain.values(b['attributes']['POSITION']))
        points = [[model.values(p['attributes']['POSITION'])[i] for (i,) in model.values(p['indices'])]
                  for model, p in ((out, a), (plain, b))]
        assert points[0] == points[1], 'other triangles'


if __name__ == '__main__':
    command = {'make': make, 'check': check, 'compare': compare, 'vertices': vertices}[sys.argv[1]]
    command(*[argument for argument in sys.argv[2:] if argument != '--flat'])
