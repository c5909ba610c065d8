#!/usr/bin/env python3
"""Makes the models in assets/: a teapot and small traps, all of girih's own design.

Usage: tools/make_assets.py [FOLDER]     (default: assets/ beside this folder)

Needs the standard library only. Run it by hand after a change; what it writes is committed. Two
runs give the same bytes (the compressed texture depends on the version of zlib too). Every mesh is
audited for cracks by exact position bits before it is written, and the counts are printed.
"""
import math
import os
import sys

from asset_writer import (FAN, LINE_LOOP, LINE_STRIP, LINES, POINTS, STRIP, U8, U16, U32, Gltf,
                          Primitive, add, bezier, cap, dot, float32, grid, lathe, lathe_row, mix, png,
                          profile, scale, smoothstep, sub, sweep, turn, unit)


# Texture ---------------------------------------------------------------------------------------

def strapwork(tile):
    """Line segments of the girih tile: from each edge's middle two rays leave at 54 degrees, and
    each ends where it meets the ray that mirrors it."""
    rays = []
    for k, a in enumerate(tile):
        b = tile[(k + 1) % len(tile)]
        e = unit(sub(b, a))
        inward = (-e[1], e[0])
        for side in (1, -1):
            c, s = math.cos(math.radians(54)) * side, math.sin(math.radians(54))
            rays.append((mix(a, b, 0.5), add(scale(e, c), scale(inward, s)), k))
    meetings = []
    for i, (p, d, k) in enumerate(rays):
        for j, (q, f, m) in enumerate(rays[:i]):
            det = f[0] * d[1] - d[0] * f[1]
            if k == m or abs(det) < 1e-9:
                continue
            w = sub(q, p)
            t, u = (f[0] * w[1] - w[0] * f[1]) / det, (d[0] * w[1] - w[0] * d[1]) / det
            if t > 1e-9 and abs(t - u) < 1e-9:
                meetings.append((round(t, 9), j, i))
    segments, used = [], set()
    for t, i, j in sorted(meetings):
        if i not in used and j not in used:
            used |= {i, j}
            meet = add(rays[i][0], scale(rays[i][1], t))
            segments += [(rays[i][0], meet), (meet, rays[j][0])]
    return segments


def inside(point, segments):
    """Even-odd rule over closed loops of segments."""
    odd = False
    for a, b in segments:
        if (a[1] > point[1]) != (b[1] > point[1]):
            odd ^= point[0] < a[0] + (point[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
    return odd


GLAZE, DEEP, SKY, IVORY, GOLD, INK = ((24, 116, 134), (14, 44, 92), (58, 160, 176),
                                      (240, 228, 198), (226, 184, 96), (8, 24, 52))
BAND_TOP, BAND_BOTTOM = 0.0625, 0.9375


def girih_texture(width=192, rows=320):
    """One period of a band of girih decagons and bow-ties between two golden lines, with plain
    glaze above and below it."""
    decagon = [scale(turn(36 * k + 18, 360), (1 + math.sqrt(5)) / 2) for k in range(10)]
    period = 2 * decagon[0][0]
    right, up = (period, 0.0), scale(turn(72, 360), period)
    # The gap between a decagon and its neighbours at the right, above and both.
    bow_tie = [decagon[0], add(right, decagon[3]), add(right, decagon[2]),
               add(add(right, up), decagon[5]), add(up, decagon[8]), decagon[1]]
    loops, centers = [], []
    for row in (-1, 0, 1):
        for column in (-2, -1, 0, 1, 2):
            origin = add(scale(right, column), scale(up, row))
            centers.append(origin)
            for tile, fill in ((decagon, SKY), (bow_tie, IVORY)):
                loop = [(add(a, origin), add(b, origin)) for a, b in strapwork(tile)]
                (x0, x1), (y0, y1) = ((min(c) - 0.2, max(c) + 0.2) for c in zip(
                    *(point for segment in loop for point in segment)))
                loops.append((loop, fill, x0, x1, y0, y1))

    height = period * 1.6
    pixel = period / width
    pixels = []
    for y in range(rows):
        band = (BAND_BOTTOM - (y + 0.5) / rows) / (BAND_BOTTOM - BAND_TOP)
        q = (band - 0.5) * height
        border = min(band, 1.0 - band) * height
        near = [entry for entry in loops if entry[4] < q < entry[5]]
        for x in range(width):
            p = ((x + 0.5) * pixel, q)
            color, nearest = DEEP, math.inf
            for loop, fill, x0, x1, _, _ in near:
                if x0 < p[0] < x1:
                    color = fill if inside(p, loop) else color
                    nearest = min([nearest] + [segment_distance(p, *s) for s in loop])
            for center in centers:
                w = sub(p, center)
                petals = 0.55 + 0.1 * math.cos(10 * math.atan2(w[1], w[0])) - math.hypot(*w)
                color = blend(color, INK, petals + 0.05, pixel)
                color = blend(color, IVORY, petals, pixel)
                color = blend(color, GOLD, petals - 0.3, pixel)
            color = blend(color, INK, 0.145 - nearest, pixel)
            color = blend(color, GOLD, 0.09 - nearest, pixel)
            color = blend(color, INK, 0.26 - border, pixel)
            color = blend(color, GOLD, 0.2 - border, pixel)
            color = blend(color, GLAZE, -border, pixel)
            pixels.append(tuple(int(c + 0.5) for c in color))
    return png(width, rows, pixels)


def segment_distance(p, a, b):
    e, w = sub(b, a), sub(p, a)
    t = min(max(dot(w, e) / dot(e, e), 0.0), 1.0)
    return math.hypot(w[0] - e[0] * t, w[1] - e[1] * t)


def blend(below, above, depth, pixel):
    """above where depth is positive, one pixel of transition around zero."""
    return mix(below, above, min(max(depth / pixel + 0.5, 0.0), 1.0))


# Teapot ----------------------------------------------------------------------------------------

def teapot(folder):
    gltf = Gltf()
    band = gltf.material("girih band", (255, 255, 255), roughness=0.25,
                         texture=gltf.texture("girih band", girih_texture()))
    glaze = gltf.material("glaze", GLAZE, roughness=0.25)
    brass = gltf.material("brass", (214, 172, 92), metallic=0.6, roughness=0.35)

    children = []
    for name, make in (("body", body), ("lid", lid), ("knob", knob), ("spout", spout),
                       ("handle", handle)):
        mesh = gltf.mesh(name, *make({"band": band, "glaze": glaze, "brass": brass}))
        children.append(gltf.node(name, mesh, root=False))
    gltf.node("teapot", children=children)
    gltf.expect()
    gltf.write(folder, "teapot.glb")


def body(materials):
    """Foot and collar of brass, a patterned band around the glazed belly: three primitives of one
    closed mesh. Only the band is textured: beside it the golden line would bleed at small sizes."""
    n, repeats = 18, 18
    belly, plain = Primitive(materials["band"]), Primitive(materials["glaze"])
    foot = Primitive(materials["brass"])
    curve = [(0.60, 0.10), (0.90, 0.18), (1.12, 0.44), (1.06, 0.82), (0.92, 1.16), (0.50, 1.26)]
    samples = [0.0, 0.14, 0.27, 0.40, 0.53, 0.66, 0.83, 1.0]
    low, high = 2, 5

    def v(t):
        return BAND_BOTTOM + (BAND_TOP - BAND_BOTTOM) * arc(samples[low], t) / arc(
            samples[low], samples[high])

    def arc(a, b):
        points = [bezier(curve, a + (b - a) * k / 64) for k in range(65)]
        return sum(math.dist(p, q) for p, q in zip(points, points[1:]))

    lathe(belly, n, profile(curve, samples[low:high + 1], v))
    lathe(plain, n, profile(curve, samples[:low + 1], v))
    lathe(plain, n, profile(curve, samples[high:], v))
    belly.uvs = [(float32(u * repeats), v) for u, v in belly.uvs]
    lathe(foot, n,
          [(0.0, 0.03, (0, -1), 1.0), (0.60, 0.0, (-0.05, -1), 0.95)],
          [(0.60, 0.0, (1, -0.35), 0.95), (0.615, 0.05, (1, 0.0), 0.9),
           (0.60, 0.10, (1, 0.35), 0.85)],
          [(0.50, 1.26, (1, 0.1), 0.3), (0.515, 1.31, (1, -0.55), 0.25)],
          [(0.515, 1.31, (0.3, 1), 0.25), (0.0, 1.33, (0, 1), 0.0)])
    return belly, plain, foot


def lid(materials):
    n = 16
    dome, rim = Primitive(materials["glaze"]), Primitive(materials["brass"])
    curve = [(0.50, 1.385), (0.46, 1.55), (0.22, 1.60), (0.10, 1.63)]
    lathe(rim, n,
          [(0.0, 1.30, (0, -1), 1.0), (0.535, 1.315, (0, -1), 0.9)],
          [(0.535, 1.315, (0.7, -0.7), 0.9), (0.565, 1.345, (1, 0.0), 0.87),
           (0.54, 1.375, (0.5, 0.9), 0.83), (0.50, 1.385, (0.1, 1), 0.8)])
    lathe(dome, n,
          profile(curve, [0.0, 0.3, 0.65, 1.0], lambda t: 0.8 - 0.7 * t),
          [(0.10, 1.63, (0, 1), 0.1), (0.0, 1.63, (0, 1), 0.0)])
    return rim, dome


def knob(materials):
    n = 12
    ball = Primitive(materials["brass"])
    curve = [(0.105, 1.60), (0.02, 1.69), (0.21, 1.70), (0.22, 1.86), (0.10, 1.92), (0.0, 1.92)]
    lathe(ball, n,
          [(0.0, 1.60, (0, -1), 1.0), (0.105, 1.60, (0, -1), 0.9)],
          profile(curve, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], lambda t: 0.9 * (1.0 - t)))
    return (ball,)


def spout(materials):
    """A tube with a rounded lip and an inner wall that one can look into."""
    n = 10
    outside, lip = Primitive(materials["glaze"]), Primitive(materials["brass"])
    spine = [(0.70, 0.46), (1.26, 0.42), (1.22, 0.94), (1.36, 1.22), (1.60, 1.40)]

    def surface(c, s, t):
        """t in 0..1 runs up the outside, in 1..2 over the lip, in 2..3 down the inner wall."""
        w = min(t, 1.0) if t < 2.0 else 3.0 - t
        w = 1.0 if 1.0 < t < 2.0 else (1.0 - 0.22 * (t - 2.0) if t >= 2.0 else t)
        x, y = bezier(spine, w)
        a, b = bezier(spine, w - 1e-3), bezier(spine, w + 1e-3)
        tx, ty = unit((b[0] - a[0], b[1] - a[1]))
        radius = 0.085 + 0.24 * (1.0 - w) ** 2.2 + 0.02 * smoothstep(0.75, 1.0, w)
        rise, tilt = 0.0, -0.45 * smoothstep(0.55, 1.0, w)
        if t > 1.0:
            over = min(t - 1.0, 1.0)
            radius *= 1.0 - 0.14 * (1.0 - math.cos(math.pi * over))
            rise = 0.018 * math.sin(math.pi * over)
        # The section lies across the spine, sheared along it towards the tip.
        in_plane, across = radius * c, radius * s * (1.0 - 0.12 * (1.0 - w))
        shift = tilt * in_plane + rise
        return (x + ty * in_plane + tx * shift, y - tx * in_plane + ty * shift, across)

    rows = sweep(outside, n, [0.0, 0.17, 0.34, 0.51, 0.68, 0.84, 1.0], surface,
                 lambda t: 1.0 - 0.8 * t)
    cap(outside, rows[0], False)
    rows = sweep(lip, n, [1.0, 1.5, 2.0, 3.0], surface, lambda t: 0.2 - 0.06 * (t - 1.0))
    cap(lip, rows[-1], True)
    return outside, lip


def handle(materials):
    """An ear: a band wider than thick, broad where it grows out of the body."""
    n = 8
    tube = Primitive(materials["glaze"])
    spine = [(-0.66, 1.08), (-1.15, 1.52), (-1.86, 1.46), (-1.76, 0.62), (-1.30, 0.52),
             (-0.80, 0.34)]

    def surface(c, s, t):
        x, y = bezier(spine, t)
        a, b = bezier(spine, t - 1e-3), bezier(spine, t + 1e-3)
        tx, ty = unit((b[0] - a[0], b[1] - a[1]))
        flare = (1.0 - smoothstep(0.0, 0.3, t)) + 0.8 * smoothstep(0.72, 1.0, t)
        thick = 0.052 + 0.05 * flare
        wide = 0.105 + 0.07 * flare
        return (x + ty * thick * c, y - tx * thick * c, wide * s)

    rows = sweep(tube, n, [k / 13 for k in range(14)], surface, lambda t: 1.0 - t)
    cap(tube, rows[0], False)
    cap(tube, rows[-1], True)
    return (tube,)


# Traps -----------------------------------------------------------------------------------------

def box(primitive, low, high, color=None):
    """Six faces with four vertices each and face normals, wound outwards."""
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    uvs = [(u, 1.0 - v) for u, v in square]
    for axis in range(3):
        for end in (0, 1):
            points = []
            for u, v in (square if end else [(b, a) for a, b in square]):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = end, u, v
                points.append(tuple(l + (h - l) * c for l, h, c in zip(low, high, corner)))
            primitive.face(*points, uvs=uvs, color=color)


def cube_hard(folder):
    gltf = Gltf()
    cube = Primitive(gltf.material("clay", (196, 120, 84)))
    box(cube, (-1, -1, -1), (1, 1, 1))
    gltf.node("cube", gltf.mesh("cube", cube))
    gltf.expect()
    gltf.write(folder, "cube_hard.glb")


def sphere_rows(columns, rows, first, last, crease=0.0):
    """Rows of a unit sphere from ring first to ring last (0 and rows are the poles). The second
    seam column, and every second vertex that lies on a coordinate plane, has -0 where its twin in
    the first column or in the other half has +0. A crease tilts the equator's normals."""
    result = []
    half = -1.0 if first == 0 else 1.0
    for j in range(first, last + 1):
        up, r = (-turn(j, 2 * rows)[0], turn(j, 2 * rows)[1])
        row = []
        for k in range(columns + 1):
            c, s = turn(k % columns, columns)
            position = [-r * s, up, -r * c]
            negative = (k == columns) != (half < 0)
            position = [math.copysign(0.0, -1.0 if negative else 1.0) if x == 0 else x
                        for x in position]
            tilt = half * crease if up == 0 else up
            normal = unit((-r * s + 0.0, tilt + 0.0, -r * c + 0.0))
            pole = r == 0.0
            row.append((tuple(position), normal, ((k + 0.5 * pole) / columns, 1.0 - j / rows)))
        result.append(row)
    return result


def seam_sphere(folder):
    gltf = Gltf()
    sphere = Primitive(gltf.material("porcelain", (214, 220, 228), roughness=0.3))
    grid(sphere, sphere_rows(16, 8, 0, 4, 0.5))
    grid(sphere, sphere_rows(16, 8, 4, 8, 0.5))
    gltf.node("seam_sphere", gltf.mesh("seam_sphere", sphere))
    gltf.expect()
    gltf.write(folder, "seam_sphere.glb")


def octahedron(flip=(), zeros=(0.0, 0.0), apart=False, material=None):
    """Eight faces; apart gives each its own vertices, and every second face the second zero."""
    shape = Primitive(material)
    shared = {}
    for face in range(8):
        signs = [1.0 if face >> axis & 1 else -1.0 for axis in range(3)]
        zero = zeros[sum(x > 0 for x in signs) % 2]
        points = [tuple(signs[a] if a == axis else zero for a in range(3)) for axis in range(3)]
        if math.prod(signs) < 0:
            points.reverse()
        if face in flip:
            points.reverse()
        if apart:
            shape.face(*points)
        else:
            for p in points:
                if p not in shared:
                    shared[p] = shape.vertex(p, p)
            shape.triangle(*(shared[p] for p in points))
    return shape


def crack_traps(folder):
    gltf = Gltf()
    clay, slate = gltf.material("clay", (196, 120, 84)), gltf.material("slate", (92, 112, 132))
    both = gltf.material("paper", (226, 214, 186), doubleSided=True)

    fan = Primitive(both)
    for k in range(3):
        c, s = turn(k, 3)
        fan.face((0.0, -1.0, 0.0), (c, 0.0, s), (0.0, 1.0, 0.0))

    collapsed = octahedron(material=clay)
    a, b = collapsed.indices[0], collapsed.indices[1]
    twin = collapsed.vertex(collapsed.positions[b], collapsed.normals[b])
    collapsed.triangle(a, b, b)
    collapsed.triangle(a, twin, b)

    # The front face is split at the middle of its top edge, the top face is not.
    sliver = Primitive(clay)
    box(sliver, (-1, -1, -1), (1, 1, 1))
    front = [k for k in range(0, 36, 3)
             if all(sliver.positions[v][2] == 1 for v in sliver.indices[k:k + 3])]
    del sliver.indices[front[0]:front[1] + 3]
    normal = (0.0, 0.0, 1.0)
    low_left, low_right, left, right = (sliver.vertex(p, normal, uv) for p, uv in (
        ((-1, -1, 1), (0, 1)), ((1, -1, 1), (1, 1)), ((-1, 1, 1), (0, 0)), ((1, 1, 1), (1, 0))))
    middle = sliver.vertex((0, 1, 1), normal, (0.5, 0))
    sliver.triangle(low_left, low_right, middle)
    sliver.triangle(low_right, right, middle)
    sliver.triangle(low_left, middle, left)
    sliver.triangle(left, middle, right)

    strip = Primitive(both)
    grid(strip, [[((x / 4 - 1.0, 0.3 * math.sin(x * 0.9), -z), unit(
        (-1.08 * math.cos(x * 0.9), 1.0, 0.0)), (x / 8, 1.0 - z)) for x in range(9)]
                 for z in (-0.5, 0.5)])

    lower, upper = Primitive(clay), Primitive(slate)
    grid(lower, sphere_rows(12, 6, 0, 3))
    grid(upper, sphere_rows(12, 6, 3, 6))

    meshes = [("negative_zeros", octahedron(zeros=(0.0, -0.0), apart=True, material=clay)),
              ("nonmanifold_fan", fan), ("collapsed", collapsed), ("sliver", sliver),
              ("flipped_neighbour", octahedron(flip=(7,), material=both)),
              ("open_strip", strip), ("two_materials", lower, upper)]
    for k, (name, *primitives) in enumerate(meshes):
        gltf.node(name, gltf.mesh(name, *primitives),
                  translation=[3.0 * (k % 4) - 4.5, -3.0 * (k // 4), 0.0])
    gltf.expect(nonmanifold_fan={"open": 6, "nonmanifold": 1}, collapsed={"degenerate": 2},
                sliver={"slivers": 1}, flipped_neighbour={"flipped": 3}, open_strip={"open": 18})
    gltf.write(folder, "crack_traps.glb")


def mirror(folder):
    """A snail shell, which has a handedness, and its mirror image under a sheared parent."""
    gltf = Gltf()
    shell = Primitive(gltf.material("shell", (222, 160, 120), roughness=0.4))

    def surface(c, s, t):
        angle = 2.0 * math.pi * 1.6 * t
        radius, thick = 0.15 + 0.85 * t * t, 0.06 + 0.34 * t
        spread = radius + thick * c
        return (spread * math.cos(angle), 1.1 - 1.3 * t + thick * s, -spread * math.sin(angle))

    rows = sweep(shell, 8, [k / 18 for k in range(19)], surface, lambda t: 1.0 - t)
    cap(shell, rows[0], False)
    cap(shell, rows[-1], True)
    mesh = gltf.mesh("shell", shell)
    gltf.node("shell", mesh, translation=[-1.8, 0.0, 0.0])
    inner = gltf.node("mirrored", mesh, root=False, scale=[-1.0, 1.0, 1.0],
                      rotation=[0.0, 0.0, float32(math.sin(0.15)), float32(math.cos(0.15))])
    gltf.node("stretched", children=[inner], translation=[1.8, 0.0, 0.0], scale=[1.0, 1.4, 0.7])
    gltf.expect()
    gltf.write(folder, "mirror.glb")


def leaf_texture(size=64):
    """A leaf with hard alpha edges, for alpha mode MASK."""
    pixels = []
    for y in range(size):
        for x in range(size):
            u, v = (x + 0.5) / size * 2.0 - 1.0, (y + 0.5) / size
            half = 0.85 * math.sin(math.pi * v) ** 0.8 * (1.0 - 0.45 * v)
            vein = abs(u) < 0.04 or abs((v * 8.0 + abs(u) * 3.0) % 1.0 - 0.5) < 0.07
            color = (150, 190, 96) if vein else (72, 140, 62)
            pixels.append(color + (255 if abs(u) < half else 0,))
    return png(size, size, pixels)


def blend_modes(folder):
    gltf = Gltf()
    block = gltf.material("opaque vertex colours", (255, 255, 255))
    leaf = gltf.material("masked leaf", (255, 255, 255), alphaMode="MASK", alphaCutoff=0.5,
                         doubleSided=True, texture=gltf.texture("leaf", leaf_texture()))
    glass = gltf.material("blended glass", (120, 190, 220), alpha=0.4, roughness=0.1,
                          alphaMode="BLEND")
    film = gltf.material("blended film", (230, 90, 120), alpha=0.5, alphaMode="BLEND",
                         doubleSided=True)

    floor = Primitive(block)
    box(floor, (-2.0, -1.2, -2.0), (2.0, -1.0, 2.0))
    floor.colors = [tuple(float32(x) for x in (0.25 + 0.35 * (p[0] / 2 + 1) / 2, 0.4,
                                               0.3 + 0.5 * (p[2] / 2 + 1) / 2, 1.0))
                    for p in floor.positions]
    ball = Primitive(glass)
    grid(ball, sphere_rows(16, 8, 0, 8))
    uvs = [(0, 1), (1, 1), (1, 0), (0, 0)]
    sheet, pane = Primitive(leaf), Primitive(film)
    sheet.face((-0.6, -1.0, 0), (0.6, -1.0, 0), (0.6, 0.8, 0), (-0.6, 0.8, 0), uvs=uvs)
    pane.face((-0.8, -1.0, 0), (0.8, -1.0, 0), (0.8, 0.6, 0), (-0.8, 0.6, 0), uvs=uvs)
    fade = [(1, 1, 1, 1), (1, 1, 1, 1), (1, 1, 1, 0.25), (1, 1, 1, 0.25)]
    pane.colors = [tuple(map(float, c)) for c in fade]

    gltf.node("floor", gltf.mesh("floor", floor))
    gltf.node("pane", gltf.mesh("pane", pane), translation=[-0.9, 0.0, 1.2])
    gltf.node("ball", gltf.mesh("ball", ball), translation=[0.8, -0.2, 0.3], scale=[0.8] * 3)
    gltf.node("leaf", gltf.mesh("leaf", sheet), translation=[-0.2, 0.0, -0.8])
    camera = gltf.append("cameras", {"name": "front", "type": "perspective", "perspective": {
        "yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1, "zfar": 50.0}})
    gltf.node("camera", camera=camera, translation=[0.0, 1.0, 7.0], rotation=[
        float32(math.sin(-0.1)), 0.0, 0.0, float32(math.cos(-0.1))])
    gltf.expect(pane={"open": 4}, leaf={"open": 4})
    gltf.write(folder, "blend.glb")


def primitives(folder):
    """The same shapes in every way glTF can list them; points and lines beside them."""
    gltf = Gltf()
    clay = gltf.material("clay", (196, 120, 84), doubleSided=True)

    strip = Primitive(clay, STRIP, U8)
    for k in range(12):
        c, s = turn(k, 12)
        for y in (-0.8, 0.8):
            strip.indices.append(strip.vertex((-s + 0.0, y, -c + 0.0), (-s + 0.0, 0.0, -c + 0.0)))
    strip.indices += strip.indices[:2]
    strip.indices = [i ^ 1 for i in strip.indices]

    fan = Primitive(clay, FAN, U16)
    fan.indices = [fan.vertex((0.0, 0.0, 0.3), (0.0, 0.0, 1.0))]
    for k in range(8):
        c, s = turn(k, 8)
        fan.indices.append(fan.vertex((c, s, 0.0), unit((0.3 * c, 0.3 * s, 1.0))))
    fan.indices.append(fan.indices[1])

    loose = octahedron(apart=True, material=clay)
    order, loose.indices = loose.indices, []
    loose.positions = [loose.positions[i] for i in order]
    loose.normals = [loose.normals[i] for i in order]

    loose_strip = Primitive(clay, STRIP)
    loose_fan = Primitive(clay, FAN)
    for i in strip.indices:
        loose_strip.vertex(strip.positions[i], strip.normals[i])
    for i in fan.indices:
        loose_fan.vertex(fan.positions[i], fan.normals[i])

    sized = []
    for index_type in (U8, U16, U32):
        shape = octahedron(material=clay)
        shape.index_type = index_type
        sized.append(shape)
    bare = octahedron(material=clay)
    bare.normals = []

    ring = [tuple(turn(k, 10)) + (0.0,) for k in range(10)]
    drawn = []
    for mode in (POINTS, LINES, LINE_LOOP, LINE_STRIP):
        shape = Primitive(clay, mode)
        for p in ring:
            shape.vertex(p)
        drawn.append(shape)

    names = ("strip", "fan", "non_indexed", "non_indexed_strip", "non_indexed_fan", "u8", "u16",
             "u32", "no_normals", "points", "lines", "line_loop", "line_strip")
    shapes = [strip, fan, loose, loose_strip, loose_fan, *sized, bare, *drawn]
    for k, (name, shape) in enumerate(zip(names, shapes)):
        gltf.node(name, gltf.mesh(name, shape),
                  translation=[2.6 * (k % 5) - 5.2, 2.6 - 2.6 * (k // 5), 0.0])
    tube, disc = {"open": 24}, {"open": 8}
    gltf.expect(strip=tube, non_indexed_strip=tube, fan=disc, non_indexed_fan=disc)
    gltf.write(folder, "primitives.glb")


def worm(folder):
    """A closed tube with a chain of joints along it and three bulges as morph targets. Vertices of
    its seam and poles have their influences in another order than their twins."""
    gltf = Gltf()
    columns, rows, half, radius = 16, 24, 2.0, 0.4
    body = Primitive(gltf.material("worm", (214, 120, 132)))
    levels = [-math.cos(math.pi * j / rows) for j in range(rows + 1)]
    grid(body, [lathe_row(columns, radius * (max(1 - y ** 6, 0.0)) ** 0.5 if 0 < j < rows else 0.0,
                          half * y, (1.0 - y ** 6, 3.0 * radius / half * y ** 5), j / rows)
                for j, y in enumerate(levels)])
    origins = [(0.0, y, 0.0) for y in (-2.0, -1.0, 0.0, 1.0)]
    for k, (_, y, _) in enumerate(body.positions):
        # Quadratic B-splines around the middles of the bones, which sum to 1.
        shares = {}
        for bone in range(-1, 5):
            d = abs(y - (bone - 1.5))
            share = 0.75 - d * d if d < 0.5 else 0.5 * (1.5 - d) ** 2 if d < 1.5 else 0.0
            joint = min(max(bone, 0), 3)
            shares[joint] = float32(shares.get(joint, 0.0) + share)
        pairs = [(joint, share) for joint, share in shares.items() if share > 0]
        body.influences.append(pairs if k % 2 else pairs[::-1])
    for middle in (-1.0, 0.0, 1.0):
        moves, turns = [], []
        for (x, y, z), normal in zip(body.positions, body.normals):
            # Wider by a factor; the slope of the profile, up by radial, goes with it.
            rest = max(1 - (y - middle) ** 2 / 0.5, 0.0)
            factor, growth = 0.8 * rest ** 2, -3.2 * rest * (y - middle) / 0.5
            moves.append(tuple(float32(factor * c) for c in (x, 0.0, z)))
            radial = math.hypot(normal[0], normal[2])
            up = normal[1] * (1 + factor) - math.hypot(x, z) * growth * radial
            turned = unit((normal[0], up, normal[2]))
            turns.append(tuple(float32(b - a) for a, b in zip(normal, turned)))
        body.targets.append((moves, turns))
    mesh = gltf.mesh("worm", body)
    gltf.json["meshes"][mesh]["extras"] = {"targetNames": ["tail", "middle", "head"]}
    joints = []
    for k in reversed(range(4)):
        joints.insert(0, gltf.node("joint %d" % k, children=joints[:1], root=k == 0,
                                   translation=[0.0, 1.0 if k else -2.0, 0.0]))
    skin = gltf.skin(joints, origins)
    # The node's own transform must not move the skinned mesh.
    node = gltf.node("worm", mesh, skin=skin, translation=[10.0, 0.0, 0.0])
    gltf.append("cameras", {"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}})
    camera = gltf.node("camera", camera=0, translation=[0.0, 0.0, 9.0])

    def turned(angle):
        return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))
    times = [0.0, 0.5, 1.0, 1.5, 2.0]
    wave = [(joint, "rotation", "LINEAR", times,
             [turned(0.7 * math.sin(math.pi * t - k)) for t in times])
            for k, joint in enumerate(joints)]
    gltf.animation("wave", *wave, (camera, "translation", "STEP", [0.0, 1.0],
                                   [(0.0, 0.0, 9.0), (0.0, 0.0, 12.0)]))
    weights = []
    for key in range(5):
        weights += [(0.0,)] * 3 + [(float(key == k + 1),) for k in range(3)] + [(0.0,)] * 3
    gltf.animation("swallow", (node, "weights", "CUBICSPLINE", times, weights))
    gltf.expect()
    gltf.write(folder, "worm.glb")


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(
        os.path.dirname(os.path.abspath(__file__)), "..", "assets")
    for make in (teapot, cube_hard, seam_sphere, crack_traps, mirror, blend_modes, primitives, worm):
        make(folder)


if __name__ == "__main__":
    main()
