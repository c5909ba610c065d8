#!/usr/bin/env python3
"""Writes a skinned, animated model: a tube that its upper joint bends, within a second. Needs nothing but Python.
Usage: view.py FILE.gltf"""
import base64
import json
import math
import struct
import sys

SIDES, ROWS = 6, 5


def pack(kind, values):
    return b''.join(struct.pack('<%d%s' % (len(v), kind), *v) for v in values)


def main(path):
    positions, normals, joints, weights, triangles = [], [], [], [], []
    for row in range(ROWS):
        for side in range(SIDES):
            angle = 2.0 * math.pi * side / SIDES
            height = row / (ROWS - 1)
            positions.append((0.2 * math.cos(angle), height, 0.2 * math.sin(angle)))
            normals.append((math.cos(angle), 0.0, math.sin(angle)))
            joints.append((0, 1, 0, 0))
            weights.append((1.0 - height, height, 0.0, 0.0))
    for row in range(ROWS - 1):
        for side in range(SIDES):
            a, b = row * SIDES + side, row * SIDES + (side + 1) % SIDES
            triangles += [(a, a + SIDES, b), (b, a + SIDES, b + SIDES)]
    identity = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    middle = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5, 0, 1)
    half = math.sqrt(0.5)
    arrays = [(5126, 'VEC3', pack('f', positions), len(positions)), (5121, 'VEC4', pack('B', joints), len(joints)),
              (5126, 'VEC4', pack('f', weights), len(weights)), (5123, 'SCALAR', pack('H', triangles), 3 * len(triangles)),
              (5126, 'MAT4', pack('f', [identity, middle]), 2), (5126, 'SCALAR', pack('f', [(0.0, 0.5, 1.0)]), 3),
              (5126, 'VEC4', pack('f', [(0, 0, 0, 1), (0, 0, half, half), (0, 0, 0, 1)]), 3),
              (5126, 'VEC3', pack('f', normals), len(normals))]
    data, views, accessors = b'', [], []
    for component, shape, block, count in arrays:
        views.append({'buffer': 0, 'byteOffset': len(data), 'byteLength': len(block)})
        accessors.append({'bufferView': len(views) - 1, 'componentType': component, 'type': shape, 'count': count})
        data += block + b'\0' * (-len(block) % 4)
    for n in (0, 5):
        columns = list(zip(*positions)) if n == 0 else [(0.0, 0.5, 1.0)]
        accessors[n]['min'], accessors[n]['max'] = [min(c) for c in columns], [max(c) for c in columns]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1]}],
        'nodes': [{'mesh': 0, 'skin': 0}, {'children': [2]}, {'translation': [0, 0.5, 0]}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0, 'NORMAL': 7, 'JOINTS_0': 1, 'WEIGHTS_0': 2}, 'indices': 3}]}],
        'skins': [{'joints': [1, 2], 'inverseBindMatrices': 4}],
        'animations': [{'name': 'bend', 'samplers': [{'input': 5, 'output': 6}],
                        'channels': [{'sampler': 0, 'target': {'node': 2, 'path': 'rotation'}}]}],
        'buffers': [{'byteLength': len(data), 'uri': 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()}],
        'bufferViews': views, 'accessors': accessors}
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(document, file)


if __name__ == '__main__':
    main(sys.argv[1])
