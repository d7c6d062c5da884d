#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/flow/plot.py: drag over the number of cells, as SVG.
#
# usage: plot.py ANGLE RESULTS >FILE.svg
import sys

REFERENCE = {'0': (0.00812, 0.00819, 0.00838), '10': (0.01225, 0.01231, 0.01251),
             '15': (0.02073, 0.02124, 0.02159)}  # Least, CFL3D, most.
WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 640, 360, 70, 20, 620, 310


def main():
    angle, rows = sys.argv[1], {}
    for line in open(sys.argv[2], encoding='utf-8'):
        cell = [c.strip() for c in line.strip().strip('|').split('|')]
        if len(cell) == 11 and cell[2].isdigit():
            # In h^2, the reference is at 0.
            rows.setdefault(cell[0], []).append((1e4 / float(cell[2]), float(cell[6])))
    low, middle, high = REFERENCE[angle]
    x_max = 1.1 * max(p[0] for r in rows.values() for p in r)
    y_min = 0.98 * min(low, *(p[1] for r in rows.values() for p in r))
    y_max = 1.02 * max(high, *(p[1] for r in rows.values() for p in r))

    def at(x, y):
        return (LEFT + (RIGHT - LEFT) * x / x_max,
                BOTTOM - (BOTTOM - TOP) * (y - y_min) / (y_max - y_min))

    def text(x, y, words, anchor='middle', more=''):
        return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>'
                f'{words}</text>')

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
           'font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>']
    top, bottom = at(0, high)[1], at(0, low)[1]
    out.append(f'<rect x="{LEFT}" y="{top:.1f}" width="{RIGHT - LEFT}" '
               f'height="{bottom - top:.1f}" fill="#dde"/>')
    y = at(0, middle)[1]
    out.append(f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="#668"/>')
    out.append(text(RIGHT - 4, y - 4, 'CFL3D, and the range of nine codes', 'end'))
    out.append(f'<path d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}" fill="none" stroke="#000"/>')
    step = 0.0005
    for i in range(int(y_min / step) + 1, int(y_max / step) + 1):
        out.append(text(LEFT - 6, at(0, i * step)[1] + 4, f'{i * step:.4f}', 'end'))
    step = 0.1 if x_max < 1 else 0.2
    step = 0.1 if x_max < 1 else 0.2
    for i in range(int(x_max / step) + 1):
        out.append(text(at(i * step, 0)[0], BOTTOM + 18, f'{i * step:.1f}'))
    out.append(text((LEFT + RIGHT) / 2, BOTTOM + 38, '10,000 / cells'))
    out.append(text(LEFT + 8, TOP + 4, f'drag coefficient at {angle} degrees', 'start'))
    for k, (name, points) in enumerate(sorted(rows.items(), reverse=True)):
        colour = ('#06c', '#c40')[k % 2]
        path = 'L'.join(f'{a:.1f} {b:.1f}' for a, b in (at(*p) for p in points))
        out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="4" fill="{colour}"/>'
                for a, b in (at(*p) for p in points)]
        out.append(text(LEFT + 8, TOP + 24 + 18 * k, name, 'start',
                        f' fill="{colour}"'))
    print('\n'.join(out + ['</svg>']))


main()
