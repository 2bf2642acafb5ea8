"""read_blob.py, which was written from docs/FORMAT.md alone, agrees with `tactree info --points` on every blob.

usage: independent_reader_test.py TACTREE FOLDER_OF_SEEDS
"""
import csv
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import read_blob

TACTREE, SEEDS = sys.argv[1], pathlib.Path(sys.argv[2])


def single(v):
    return struct.unpack("f", struct.pack("f", v))[0]


class IndependentReader(unittest.TestCase):
    def compare(self, path):
        blob = read_blob.parse(path.read_bytes())
        with tempfile.TemporaryDirectory() as folder:
            table = pathlib.Path(folder, "points.csv")
            subprocess.run([TACTREE, "info", path, "--points", table], check=True,
                           stdout=subprocess.DEVNULL)
            rows = list(csv.reader(table.read_text().splitlines()))[1:]
        mine = list(read_blob.points(blob))
        self.assertEqual(len(mine), len(rows))
        self.assertEqual(len(mine), blob.counts["points"])
        for index, (row, (position, normal)) in enumerate(zip(rows, mine)):
            self.assertEqual(int(row[0]), index)
            for text, v in zip(row[1:4], position):
                self.assertEqual(single(float(text)), v, "positions are the same to the bit")
            for text, v in zip(row[4:7], normal):
                self.assertAlmostEqual(float(text), v, delta=2e-7)
        self.assertEqual(list(blob.directory), read_blob.expected_directory(blob))
        if blob.neighbours:
            self.assertEqual(list(blob.neighbours), list(read_blob.expected_neighbours(blob)))
        return bool(blob.neighbours)

    def test_valid_blobs(self):
        paths = sorted(SEEDS.glob("kOk.*"))
        self.assertGreaterEqual(len(paths), 8)
        self.assertGreaterEqual(sum(self.compare(path) for path in paths), 3)

    def test_interior(self):
        path = SEEDS / "kOk.surface_interior"
        blob = read_blob.parse(path.read_bytes())
        numbers = random.Random(3)
        places = [tuple(numbers.uniform(-0.08, 0.08) for _ in range(3)) for _ in range(500)]
        answers = subprocess.run([TACTREE, "query", path, "--points", "-"], check=True, text=True,
                                 input="".join("%.9g,%.9g,%.9g\n" % place for place in places),
                                 stdout=subprocess.PIPE).stdout
        rows = list(csv.DictReader(answers.splitlines()))
        far = [(place, row) for place, row in zip(places, rows) if row["signed_distance_m"] == ""]
        self.assertGreater(len(far), 250)
        for place, row in far:
            unit = [math.floor(single(c) / blob.step_m) for c in place]
            here, _ = read_blob.interior(blob, unit)
            self.assertEqual(row["inside"], str(int(here)), place)
            self.assertEqual(here, math.dist(place, (0, 0, 0)) < 0.05)
        for _, _, low in read_blob.walk(blob):
            self.assertEqual(read_blob.interior(blob, low)[1], True, "material behind every leaf")

    def test_refuses_damage(self):
        data = (SEEDS / "kOk.surface").read_bytes()
        for damaged in (data[:-4], data + b"\0\0\0\0", data[:40] + bytes([data[40] ^ 1]) + data[41:],
                        b"X" + data[1:]):
            with self.assertRaises(ValueError):
                read_blob.parse(damaged)

    def test_refuses_tree_out_of_order(self):
        data = bytearray((SEEDS / "kBadTree.cycle").read_bytes())
        self.assertEqual(struct.unpack_from("<I", data, 20)[0], zlib.crc32(data[24:], zlib.crc32(data[:20])))
        with self.assertRaises(ValueError):
            list(read_blob.walk(read_blob.parse(bytes(data))))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
