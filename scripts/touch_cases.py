#!/usr/bin/env python3
"""Writes exact meshes with a hand path each on which haptic renderers are known to fail.

usage: touch_cases.py FOLDER      writes per case CASE.list (the meshes), CASE-*.obj, CASE.json (scene), CASE.csv (hand)

  bracket  inner corner of 90 degrees, the hand behind both faces slides along it
  groove   groove of 60 degrees, pressed to its bottom and below
  seam     two boxes with flush faces, the hand slides over their seam
"""
import argparse
import json
import pathlib


def prism(outline, y_min, y_max):
    """Vertices and faces of a prism along y; outline: (x, z), m, counter-clockwise seen from -y."""
    n = len(outline)
    vertices = [(x, y, z) for y in (y_min, y_max) for x, z in outline]
    sides = [(i, n + i, n + (i + 1) % n, (i + 1) % n) for i in range(n)]
    return vertices, [tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *sides]


def box(x_min, x_max, y, z):
    return prism([(x_min, -z), (x_max, -z), (x_max, z), (x_min, z)], -y, y)


# Meshes and hand path, rows of t_s, x, y, z (s, m).
CASES = {
    "bracket": ([prism([(-0.03, 0), (0.03, 0), (0.03, 0.01), (-0.018, 0.01), (-0.018, 0.04), (-0.03, 0.04)],
                       -0.03, 0.03)],
                [(0, 0, -0.02, 0.03), (1, -0.020, -0.02, 0.008), (1.5, -0.020, -0.02, 0.008),
                 (3, -0.020, 0.02, 0.008)]),
    "groove": ([prism([(-0.03, -0.022), (0.03, -0.022), (0.03, 0), (0.0057735, 0), (0, -0.01), (-0.0057735, 0),
                       (-0.03, 0)], -0.02, 0.02)],
               [(0, 0, 0, 0.005), (2, 0, 0, -0.015), (3, 0, 0.005, -0.015)]),
    "seam": ([box(-0.02, 0, 0.015, 0.01), box(0, 0.02, 0.015, 0.01)],
             [(0, -0.015, 0, 0.02), (0.4, -0.015, 0, 0.008), (2, 0.015, 0.001, 0.008)]),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    folder = parser.parse_args().folder
    for name, (meshes, path) in CASES.items():
        files = [f"{name}-{i}" for i in range(len(meshes))]
        for file, (vertices, faces) in zip(files, meshes):
            lines = [f"v {x} {y} {z}" for x, y, z in vertices]
            lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
            (folder / f"{file}.obj").write_text("\n".join(lines) + "\n")
        (folder / f"{name}.list").write_text("\n".join(files) + "\n")
        (folder / f"{name}.json").write_text(json.dumps({"bodies": [{"blob": i} for i in range(len(meshes))]}))
        (folder / f"{name}.csv").write_text("t_s,x,y,z\n" + "".join("%g,%g,%g,%g\n" % row for row in path))


if __name__ == "__main__":
    main()
