#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/flow/gmsh.py: gmsh's mesh of a section whose walls have the points of a
# mesh of Vanguard: quadrilaterals in its boundary layer, triangles elsewhere, one cell
# thick.
#
# usage: gmsh.py MESH.su2 OUT.geo FIRST RATIO HEIGHT GROWTH FARFIELD
#   HEIGHT of the layers; edges grow with GROWTH away from the walls, up to a circle
#   FARFIELD away from the middle of the chord
import math
import sys


def read_wall(name):
    """Points of the first marker of a mesh in two dimensions, in order."""
    lines = iter(open(name, encoding='ascii'))
    points, edges = [], {}
    for line in lines:
        key, _, value = line.partition('=')
        if key.strip() == 'NPOIN':
            for _ in range(int(value.split()[0])):
                points.append([float(v) for v in next(lines).split()[:2]])
        elif key.strip() == 'MARKER_ELEMS' and not edges:
            for _ in range(int(value)):
                _, a, b = next(lines).split()[:3]
                edges[int(a)] = int(b)
    first = max(edges, key=lambda p: points[p][0])  # The trailing edge.
    loop, at = [first], edges[first]
    while at != first:
        loop.append(at)
        at = edges[at]
    return [points[p] for p in loop]


def section(su2, geo, first, ratio, height, growth, far):
    """Writes the .geo: layers, a fan at the trailing edge, and a size that grows with
    the distance from the nearest edge of the wall."""
    wall = read_wall(su2)
    n = len(wall)
    edge = [math.dist(wall[i], wall[(i + 1) % n]) for i in range(n)]
    out = [f'Point({i + 1}) = {{{x!r}, {y!r}, 0, '
           f'{0.5 * (edge[i] + edge[i - 1])!r}}};' for i, (x, y) in enumerate(wall)]
    # Two splines, divided alike: gmsh's layers fail on a line for each edge.
    nose = min(range(n), key=lambda i: wall[i][0])
    least = min(edge[nose], edge[0]) * (nose + 1) / sum(edge[:nose])
    out += [f'Spline(1) = {{1:{nose + 1}}};',
            f'Spline(2) = {{{nose + 1}:{n}, 1}};',
            f'Transfinite Curve {{1}} = {nose + 1} Using Bump {least!r};',
            f'Transfinite Curve {{2}} = {n - nose + 1} Using Bump {least!r};']
    out += [f'Point({n + 1}) = {{0.5, 0, 0}};']
    # Two circles: gmsh does not recover the tops of the layers in one surface that
    # is a thousand chords wide. Edges are those of a field that grows from the
    # largest edge.
    for c, radius in enumerate((2, far)):
        end = max(edge) + (growth - 1) * (radius - 0.5)
        at = n + 2 + 4 * c
        out += [f'Point({at + i}) = {{{0.5 + radius * x}, {radius * y}, 0, {end!r}}};'
                for i, (x, y) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1)))]
        out += [f'Circle({3 + 4 * c + i}) = {{{at + i}, {n + 1}, {at + (i + 1) % 4}}};'
                for i in range(4)]
    out += ['Curve Loop(1) = {1, 2};', 'Curve Loop(2) = {3:6};',
            'Curve Loop(3) = {7:10};', 'Plane Surface(1) = {2, 1};',
            'Plane Surface(2) = {3, 2};',
            # Edges of the walls extended, and at most the largest one with its growth.
            'Field[1] = Distance;', 'Field[1].CurvesList = {1, 2};',
            'Field[1].NumPointsPerCurve = 400;',
            'Field[3] = MathEval;',
            f'Field[3].F = "{max(edge)!r} + {growth - 1!r} * F1";']
    out += ['Background Field = 3;',
            'Field[2] = BoundaryLayer;', 'Field[2].CurvesList = {1, 2};',
            f'Field[2].Size = {first!r};', f'Field[2].Ratio = {ratio};',
            f'Field[2].Thickness = {height};', 'Field[2].Quads = 1;',
            'Field[2].FanPointsList = {1};', 'BoundaryLayer Field = 2;',
            'Physical Curve("farfield") = {7:10};',
            'Physical Curve("wall") = {1, 2};',
            'Physical Surface("fluid") = {1, 2};', 'Mesh.MshFileVersion = 2.2;']
    with open(geo, 'w', encoding='ascii') as file:
        file.write('\n'.join(out) + '\n')


def extrude(plane, out):
    """The mesh of a plane becomes one cell thick. gmsh's own extrusion does not find
    the points of its boundary layers."""
    lines = iter(open(plane, encoding='ascii'))
    name, point, element = {}, [], []
    for line in lines:
        if line.startswith('$PhysicalNames'):
            for _ in range(int(next(lines))):
                _, tag, text = next(lines).split()
                name[tag] = text.strip('"')
        elif line.startswith('$Nodes'):
            point = [next(lines).split() for _ in range(int(next(lines)))]
        elif line.startswith('$Elements'):
            element = [next(lines).split() for _ in range(int(next(lines)))]
    index = {p[0]: i + 1 for i, p in enumerate(point)}
    n = len(point)
    tags = {'farfield': 1, 'wall': 2, 'back': 3, 'front': 4, 'fluid': 5}
    made = []
    for e in element:
        tag, at = name[e[3]], [index[p] for p in e[3 + int(e[2]):]]
        top = [p + n for p in at]
        if len(at) == 2:  # An edge: a quadrilateral.
            made.append((3, tags[tag], at + top[::-1]))
        else:
            plane_kind = {3: 2, 4: 3}[len(at)]
            made.append((plane_kind, tags['back'], at))
            made.append((plane_kind, tags['front'], top))
            made.append(({3: 6, 4: 5}[len(at)], tags['fluid'], at + top))
    with open(out, 'w', encoding='ascii') as file:
        file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n')
        for text, tag in tags.items():
            file.write(f'{3 if text == "fluid" else 2} {tag} "{text}"\n')
        file.write(f'$EndPhysicalNames\n$Nodes\n{2 * n}\n')
        for z in (0, 1):
            for i, p in enumerate(point):
                file.write(f'{i + 1 + z * n} {p[1]} {p[2]} {z}\n')
        file.write(f'$EndNodes\n$Elements\n{len(made)}\n')
        for i, (kind, tag, at) in enumerate(made):
            file.write(f'{i + 1} {kind} 2 {tag} {tag} {" ".join(map(str, at))}\n')
        file.write('$EndElements\n')


if sys.argv[1] == 'extrude':
    extrude(*sys.argv[2:])
else:
    section(*sys.argv[2:4], *(float(v) for v in sys.argv[4:]))
