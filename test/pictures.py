#!/usr/bin/env python3
"""What holds for pictures, by their pixels. Needs nothing but Python.
Usage: pictures.py quad FILE.gltf | legend WITH WITHOUT CORNER [+R,G,B | -R,G,B]... | halves BOTH LEFT RIGHT |
composed TRANSPARENT OPAQUE SAMPLES | lines PLAIN WIREFRAME WIDTH | density PNG PIXELS | brighter DARK BRIGHT"""
import base64
import json
import math
import struct
import sys

from panorama import read_png

DENSITIES = ((0.55, 0.00, 0.38), (0.84, 0.19, 0.15), (0.96, 0.55, 0.26), (0.99, 0.88, 0.50), (0.60, 0.84, 0.64),
             (0.27, 0.52, 0.77), (0.20, 0.20, 0.58))
LINE, STRENGTH = (0.07, 0.09, 0.13), 0.92


def linear(value):
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


LINEAR = [linear(n / 255) for n in range(256)]


def write_quad(path):
    """A square of side 1 in the plane z = 0, two triangles, seen from +z."""
    data = struct.pack('<12f6H', -.5, -.5, 0, .5, -.5, 0, .5, .5, 0, -.5, .5, 0, 0, 1, 2, 0, 2, 3)
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'type': 'VEC3', 'count': 4, 'min': [-.5, -.5, 0],
                       'max': [.5, .5, 0]}, {'bufferView': 1, 'componentType': 5123, 'type': 'SCALAR', 'count': 6}],
        'bufferViews': [{'buffer': 0, 'byteLength': 48}, {'buffer': 0, 'byteOffset': 48, 'byteLength': 12}],
        'buffers': [{'byteLength': 60, 'uri': 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()}]}
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(document, file)


def legend(with_path, without_path, corner, *colors):
    """The pictures differ in a rectangle in the corner alone, where colours with + are to be seen, and with - not."""
    with_, without = read_png(with_path), read_png(without_path)
    width, height = len(with_[0]), len(with_)
    places = [(x, y) for y in range(height) for x in range(width) if with_[y][x] != without[y][x]]
    assert places, 'there is none'
    left, right = min(x for x, y in places), max(x for x, y in places)
    top, bottom = min(y for x, y in places), max(y for x, y in places)
    assert len(places) > 0.6 * (right - left + 1) * (bottom - top + 1), 'it is not a panel'
    margin = 20
    assert (bottom > height - margin) == ('bottom' in corner) and (top < margin) == ('top' in corner), (top, bottom)
    assert (right > width - margin) == ('right' in corner) and (left < margin) == ('left' in corner), (left, right)
    for color in colors:
        wanted = [float(part) * 255 for part in color[1:].split(',')]
        count = sum(max(abs(a - b) for a, b in zip(with_[y][x], wanted)) <= 1.5
                    for y in range(top, bottom + 1) for x in range(left, right + 1))
        assert (count >= 20) == (color[0] == '+'), '%d pixels of %s' % (count, color)


def halves(both_path, left_path, right_path):
    """Both has the others side by side, but for the line between them."""
    both, left, right = (read_png(path) for path in (both_path, left_path, right_path))
    width, half = len(both[0]), len(left[0])
    for y, row in enumerate(both):
        middle = (width - 2) // 2
        assert row[:middle] == left[y][:middle] and row[middle + 2:] == right[y][half - (width - middle - 2):], \
            'row %d' % y
        assert row[middle] == row[middle + 1] == both[0][middle], 'no line in row %d' % y


def composed(transparent_path, opaque_path, samples):
    """The one without a background, laid over the other's, is the other."""
    transparent, opaque = read_png(transparent_path, 4), read_png(opaque_path)
    alphas = set()
    for y, row in enumerate(transparent):
        ground = opaque[y][0]
        assert row[0][3] == row[-1][3] == 0, 'something at the border'
        for x, (*color, alpha) in enumerate(row):
            alphas.add(alpha)
            for n in range(3):
                light = (LINEAR[color[n]] * alpha + LINEAR[ground[n]] * (255 - alpha)) / 255
                assert abs(light - LINEAR[opaque[y][x][n]]) < 0.012, (x, y, color, alpha, opaque[y][x])
    assert len(alphas) == int(samples) + 1, 'alphas: %s' % sorted(alphas)


def lines(plain_path, wireframe_path, width):
    """Through the middle of a quad with two segments an edge goes a horizontal line, `width` pixels of ink."""
    plain, wireframe = read_png(plain_path), read_png(wireframe_path)
    column = len(plain[0]) // 2 + 20
    middle = len(plain) // 2
    ink = 0.0
    for y in range(middle - 12, middle + 12):
        paper = LINEAR[plain[y][column][1]]
        ink += (paper - LINEAR[wireframe[y][column][1]]) / (paper - linear(LINE[1]))
    print('%.2f pixels of ink' % ink)
    assert abs(ink - float(width) * STRENGTH) < 0.12, 'not %s times %g' % (width, STRENGTH)


def density(path, pixels):
    """In the middle is the colour, more or less lit, of triangles that cover so many pixels."""
    place = min(max(0.5 * math.log2(float(pixels)) + 1.0, 0.0), 6.0)
    first = min(int(place), 5)
    wanted = [linear(a + (b - a) * (place - first)) for a, b in zip(DENSITIES[first], DENSITIES[first + 1])]
    rows = read_png(path)
    color = [LINEAR[n] for n in rows[len(rows) // 2 + 3][len(rows[0]) // 2 + 11]]
    light = sum(color) / sum(wanted)
    print('light %.2f' % light, color, wanted)
    assert 0.5 < light <= 1.01 and all(abs(a - light * b) < 0.012 for a, b in zip(color, wanted))


def brighter(dark_path, bright_path):
    dark, bright = (sum(LINEAR[n] for row in read_png(path) for pixel in row for n in pixel)
                    for path in (dark_path, bright_path))
    assert bright > 1.1 * dark, (dark, bright)


if __name__ == '__main__':
    {'quad': write_quad, 'legend': legend, 'halves': halves, 'composed': composed, 'lines': lines, 'density': density,
     'brighter': brighter}[sys.argv[1]](*sys.argv[2:])
