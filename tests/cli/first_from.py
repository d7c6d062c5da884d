#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wall shear of a made-up solution, and first heights measured in a mesh.

    first_from.py write MESH.lb8.ugrid SOLUTION.vtu WALLS FIELD FUNCTION
    first_from.py measure MESH.b8.ugrid WALLS FUNCTION

WALLS are numbers of patches, as in 1,2. FUNCTION of x, y, z and the functions
of `math` is the skin friction coefficient; as a tuple it is a vector. If the mesh
has tetrahedra, the solution consists of them, with zeros away from the walls;
otherwise of the triangles of the walls, as a .vtu or .vtp. For
`measure` it is the first height, and the prisms on the walls are compared with
it: the output is the share of the wall points, in per cent, whose height is
within 5 % of it, and the number of these points, without those on edges.
"""
import array
import math
import sys


def read(path):
    """Points, triangles of the boundary with their patches, tetrahedra and
    prisms."""
    order = "little" if ".lb8." in path else "big"
    with open(path, "rb") as f:
        def get(kind, n):
            a = array.array(kind)
            a.fromfile(f, n)
            if order != sys.byteorder:
                a.byteswap()
            return a
        n_point, n_tri, n_quad, n_tet, n_pyr, n_pri, _ = get("i", 7)
        x = get("d", 3 * n_point)
        tri = get("i", 3 * n_tri)
        get("i", 4 * n_quad)
        ids = get("i", n_tri + n_quad)
        tet = get("i", 4 * n_tet)
        get("i", 5 * n_pyr)
        pri = get("i", 6 * n_pri)
    return ([tuple(x[i:i + 3]) for i in range(0, len(x), 3)],
            [(tuple(v - 1 for v in tri[3 * i:3 * i + 3]), ids[i])
             for i in range(n_tri)],
            [tuple(v - 1 for v in tet[i:i + 4])
             for i in range(0, len(tet), 4)],
            [tuple(v - 1 for v in pri[i:i + 6])
             for i in range(0, len(pri), 6)])


def function(text, x):
    names = dict(vars(math), x=x[0], y=x[1], z=x[2])
    return eval(text, {"__builtins__": {}}, names)


def data(f, kind, name, components, rows):
    f.write(f'<DataArray type="{kind}" Name="{name}" '
            f'NumberOfComponents="{components}" format="ascii">\n')
    for row in rows:
        f.write(" ".join(f"{v:.17g}" for v in row) + "\n")
    f.write("</DataArray>\n")


def write(mesh, path, walls, field, text):
    x, tri, tet, _ = read(mesh)
    tri = [t for t, patch in tri if patch in walls]
    wall = {p for t in tri for p in t}
    cells = tet or tri
    number = {p: i for i, p in enumerate(sorted({p for t in cells for p in t}))}
    values = [function(text, x[p]) if p in wall else 0 for p in number]
    values = [v if isinstance(v, tuple) else (v,) for v in values]
    kind, tag, count = (("PolyData", "Polys", "NumberOfPolys")
                        if path.endswith(".vtp") else
                        ("UnstructuredGrid", "Cells", "NumberOfCells"))
    width = len(cells[0])
    with open(path, "w") as f:
        f.write(f'<VTKFile type="{kind}" version="1.0" '
                f'byte_order="LittleEndian"><{kind}><Piece '
                f'NumberOfPoints="{len(number)}" {count}="{len(cells)}">\n'
                '<PointData>\n')
        data(f, "Float64", field, len(values[0]), values)
        f.write("</PointData><Points>\n")
        data(f, "Float64", "Points", 3, (x[p] for p in number))
        f.write(f"</Points><{tag}>\n")
        data(f, "Int32", "connectivity", 1,
             ((number[p],) for t in cells for p in t))
        data(f, "Int32", "offsets", 1,
             ((width * (i + 1),) for i in range(len(cells))))
        if tag == "Cells":
            data(f, "UInt8", "types", 1, ((10 if tet else 5,) for _ in cells))
        f.write(f"</{tag}></Piece></{kind}></VTKFile>\n")


def normal(x, base):
    a, b, c = (x[p] for p in base)
    u = [b[k] - a[k] for k in range(3)]
    v = [c[k] - a[k] for k in range(3)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
         u[0] * v[1] - u[1] * v[0]]
    size = math.sqrt(sum(k * k for k in n))
    return [k / size for k in n]


def dot(a, b):
    return sum(a[k] * b[k] for k in range(3))


def measure(mesh, walls, text):
    """The height is the distance of the top from the plane of a triangle, at
    points whose triangles have nearly the same plane."""
    x, tri, _, prisms = read(mesh)
    faces = {frozenset(t) for t, _ in tri}
    wall = {p for t, patch in tri if patch in walls for p in t}
    normals, heights = {}, {}
    for prism in prisms:
        for base, top in ((prism[:3], prism[3:]), (prism[3:], prism[:3])):
            if frozenset(base) not in faces:
                continue
            n = normal(x, base)
            for p, q in zip(base, top):
                d = [x[q][k] - x[p][k] for k in range(3)]
                normals.setdefault(p, []).append(n)
                heights.setdefault(p, []).append(abs(dot(d, n)))
    flat = [p for p, n in normals.items()
            if p in wall and all(abs(dot(n[0], k)) > 0.99 for k in n)]
    good = sum(all(abs(h / function(text, x[p]) - 1) <= 0.05
                   for h in heights[p]) for p in flat)
    print(100 * good // len(flat), len(flat))


if sys.argv[1] == "write":
    write(sys.argv[2], sys.argv[3], set(map(int, sys.argv[4].split(","))),
          sys.argv[5], sys.argv[6])
else:
    measure(sys.argv[2], set(map(int, sys.argv[3].split(","))), sys.argv[4])
