"""Pictures of models without a display: build --preview and info --preview.

usage: preview_test.py TACTREE
"""
import math
import pathlib
import struct
import sys
import unittest
import zlib

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, ball, csv  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def shell(hole):
    """Points of a sphere of 4 cm, with normals, except those within `hole` (in radii) of the +x axis."""
    return csv((p, n) for p, n in ball(20000, 0.04) if math.dist(n, (1, 0, 0)) > hole)


def add_left(line, _):
    for i in range(3, len(line)):
        line[i] = (line[i] + line[i - 3]) & 255


def add_above(line, above):
    for i in range(3, len(line)):
        line[i] = (line[i] + above[i]) & 255


def add_mean(line, above):
    for i in range(3, len(line)):
        line[i] = (line[i] + (line[i - 3] + above[i]) // 2) & 255


def add_paeth(line, above):
    for i in range(3, len(line)):
        left, up, corner = line[i - 3], above[i], above[i - 3]
        to_left, to_up, to_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
        near = left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
        line[i] = (line[i] + near) & 255


UNFILTER = (lambda *_: None, add_left, add_above, add_mean, add_paeth)


def pixels(file):
    """Width, height and rows of (r, g, b) of an 8-bit PNG without interlacing."""
    data = file.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert (depth, kind) == (8, 2)
    packed, at = b"", 8
    while at < len(data):
        size = struct.unpack(">I", data[at:at + 4])[0]
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    raw = zlib.decompress(packed)
    rows, above = [], bytes(3 * width + 3)
    for y in range(height):
        # Three bytes of zero before each line: the pixel to the left of the first one.
        begin = y * (3 * width + 1)
        line = bytearray(3) + raw[begin + 1:begin + 3 * width + 1]
        UNFILTER[raw[begin]](line, above)
        above = bytes(line)
        rows.append([tuple(line[i:i + 3]) for i in range(3, 3 * width + 3, 3)])
    return width, height, rows


def reds(rows):
    return [(x, y) for y, row in enumerate(rows) for x, (r, g, b) in enumerate(row)
            if r > 190 and g < 60 and b < 80]


def purples(rows):
    return [(x, y) for y, row in enumerate(rows) for x, (r, g, b) in enumerate(row)
            if b > 1.25 * r > 1.5 * g]


class Preview(SharedFolder):
    tool = TACTREE

    def build(self, hole, *options):
        (self.path / "ball.csv").write_text(shell(hole))
        return self.run_tool("build", "ball.csv", "-o", "ball.blob", "--preview", "built.png", *options)

    def test_marks_hole_in_front_view(self):
        self.assertEqual(self.build(0.25).returncode, 0)
        self.assertEqual(self.run_tool("info", "ball.blob", "--preview", "known.png").returncode, 0)
        for name in ("built.png", "known.png"):
            width, height, rows = pixels(self.path / name)
            self.assertEqual((width, height), (1280, 720))
            marked = reds(rows)
            self.assertGreater(len(marked), 200, name)
            # The left half shows the model from +x; behind the model, the mark is faint.
            self.assertLess(max(x for x, _ in marked), width // 2, name)

    def test_legend_shows_mark_colour(self):
        self.assertEqual(self.build(0.25).returncode, 0)
        _, _, rows = pixels(self.path / "built.png")
        corner = [rows[y][x] for y in range(20, 34) for x in range(40, 54)]
        self.assertEqual(len(set(corner)), 1)
        self.assertTrue(reds([corner]))

    def test_closed_surface_has_no_mark(self):
        self.assertEqual(self.build(0.0).returncode, 0)
        _, _, rows = pixels(self.path / "built.png")
        self.assertEqual(reds(rows), [])
        shades = {pixel for row in rows[::7] for pixel in row[::7]}
        self.assertGreater(len(shades), 100)

    def test_colours_points_of_ambiguous_orientation(self):
        rows = [f"{0.001 * i} {0.001 * j} {0.002 * math.sin(0.1 * i)}" for i in range(60) for j in range(60)]
        (self.path / "sheet.xyz").write_text("\n".join(rows) + "\n")
        for options, doubtful in (((), True), (("--viewpoint", "0,0,1"), False)):
            done = self.run_tool("build", "sheet.xyz", "-o", "y", "--preview", "y.png", *options)
            self.assertEqual("ambiguous" in done.stderr, doubtful, done.stderr)
            _, _, picture = pixels(self.path / "y.png")
            corner = [picture[y][x] for y in range(21, 33) for x in range(41, 53)]
            self.assertEqual(len(purples([corner])), len(corner) if doubtful else 0)
            self.assertEqual(len(purples(picture)) > 20000, doubtful)

    def painted(self, *options):
        """A ball that is blue where z > 0 and green elsewhere."""
        rows = [f"{p[0]} {p[1]} {p[2]} {'20 30 240' if n[2] > 0 else '20 200 30'}" for p, n in ball(20000, 0.04)]
        (self.path / "painted.csv").write_text("x y z red green blue\n" + "\n".join(rows) + "\n")
        return self.run_tool("build", "painted.csv", "-o", "painted.blob", "--preview", "painted.png", *options)

    def assert_painted(self, name):
        width, height, rows = pixels(self.path / name)
        red, green, blue = rows[height // 4][width // 4]
        self.assertGreater(blue, 2 * max(red, green), name)
        red, green, blue = rows[2 * height // 3][width // 4]
        self.assertGreater(green, 2 * max(red, blue), name)

    def test_draws_colours_of_scan(self):
        done = self.painted("--colours", "painted.colours")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_painted("painted.png")
        done = self.run_tool("info", "painted.blob", "--colours", "painted.colours", "--preview", "known.png")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_painted("known.png")
        header = (self.path / "painted.colours").read_bytes()
        self.assertEqual(header[:12], b"TACTCOL\0" + struct.pack("<I", 1))
        points = struct.unpack("<I", header[12:16])[0]
        self.assertEqual(len(header), 80 + 3 * points)

    def test_build_names_option_for_colours(self):
        line = "colours   the scan has some: --colours FILE keeps them"
        self.assertIn(line, self.painted().stdout)
        self.assertNotIn(line, self.painted("--colours", "painted.colours").stdout)
        self.assertNotIn(line, self.build(0.0).stdout)

    def test_refuses_foreign_and_damaged_colours(self):
        self.assertEqual(self.painted("--colours", "painted.colours").returncode, 0)
        self.assertEqual(self.build(0.0).returncode, 0)
        good = (self.path / "painted.colours").read_bytes()
        for blob, content, cause in (
                ("ball.blob", good, "belongs to another blob than ball.blob"),
                ("painted.blob", good[:-1], "its size is not that of the colours"),
                ("painted.blob", good + b"0", "its size is not that of the colours"),
                ("painted.blob", good[:40], "is not a file of colours"),
                ("painted.blob", good[:8] + b"\2" + good[9:], "has version 2")):
            (self.path / "bad.colours").write_bytes(content)
            done = self.run_tool("info", blob, "--colours", "bad.colours", "--preview", "bad.png")
            self.assertEqual(done.returncode, 1, cause)
            self.assertIn("bad.colours: " + cause, done.stderr)
            self.assertFalse((self.path / "bad.png").exists())
        done = self.build(0.0, "--colours", "none.colours")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no input has colours at its points", done.stderr)
        self.assertFalse((self.path / "none.colours").exists())

    def test_never_overwrites_scan(self):
        before = shell(0.0)
        done = self.build(0.0, "--preview", "ball.csv")
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual((self.path / "ball.csv").read_text(), before)


if __name__ == "__main__":
    unittest.main(verbosity=2)
