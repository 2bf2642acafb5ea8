"""tactree.load, Model and query: what the tool prints for the same blob.

usage: model_test.py TACTREE
"""
import csv
import gc
import pathlib
import sys
import unittest

import numpy as np
import tactree

from clouds import ModelFolder, probes, runs_beside, signal_during, tool_error, write_rows

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
FLOATS = ("distance_m", "surface_x", "surface_y", "surface_z", "normal_x", "normal_y", "normal_z", "signed_distance_m")


class Folder(ModelFolder):
    tool = TACTREE

    def tool_answers(self, positions, *options):
        write_rows(self.path / "probes.csv", "x,y,z", positions)
        done = self.run_tool("query", self.blob, "--points", "probes.csv", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(done.stdout.splitlines()))

    def expect_same(self, answers, rows):
        self.assertEqual(len(answers), len(rows))
        self.assertEqual(list(answers.dtype.names), list(rows[0]))
        for answer, row in zip(answers, rows):
            for axis in "xyz":
                self.assertEqual(np.float32(row[axis]), answer[axis])
            for name in ("contact_paper", "contact", "nearest"):
                self.assertEqual(int(row[name]), answer[name])
            for name in FLOATS:
                # Nine digits identify a float32, and are what the tool prints of a float64.
                self.assertEqual(row[name], "" if np.isnan(answer[name]) else f"{float(answer[name]):.9g}", name)
            self.assertEqual(int(row["inside"] or -1), answer["inside"])


class Query(Folder):
    def test_equals_tool(self):
        positions = np.vstack([probes(), [[1, 1, 1], [0, 0, 0]]])
        rows = self.tool_answers(positions)
        self.expect_same(self.model.query(positions), rows)
        # All cases occur: with and without surface, inside and outside.
        self.assertEqual({row["inside"] for row in rows}, {"0", "1"})
        self.assertEqual({row["surface_x"] == "" for row in rows}, {False, True})

    def test_radius_equals_tool(self):
        positions = probes(50)
        for radius in (0.0005, 0.02):  # below the reach, and above, where all points are searched
            self.expect_same(self.model.query(positions, radius_m=radius),
                             self.tool_answers(positions, "--radius", radius))

    def test_nearest_equals_exhaustive_search(self):
        positions = probes(50).astype(np.float32)
        index, distance = self.model.nearest(positions, radius_m=1.0)
        gaps = np.linalg.norm(self.model.points[None] - positions[:, None], axis=2)
        np.testing.assert_allclose(distance, gaps.min(axis=1), rtol=1e-5)
        np.testing.assert_allclose(gaps[np.arange(50), index], gaps.min(axis=1), rtol=1e-5)

    def test_accepts_lists_and_single_positions(self):
        one = self.model.query([0, 0, 0.031])
        self.assertEqual(one.shape, (1,))
        self.assertAlmostEqual(float(one["signed_distance_m"][0]), 0.001, places=4)
        np.testing.assert_allclose(tactree.vectors(one, "normal"), [[0, 0, 1]], atol=0.05)
        strided = np.zeros((4, 6), np.float32)[:, ::2]
        self.assertEqual(len(self.model.query(strided)), 4)
        self.assertEqual(len(self.model.query(np.empty((0, 3)))), 0)

    def test_refuses_other_shapes_and_numbers(self):
        for positions, words in (([[0, 0]], "positions: the shape (1, 2) is not (N, 3)"), ([0.0], "the shape (1,)"),
                                 ([[0, 0, 0], [0, np.nan, 0]], r"positions[1]: is not finite")):
            with self.assertRaises(tactree.Error) as refused:
                self.model.query(positions)
            self.assertIn(words, str(refused.exception))
        with self.assertRaisesRegex(tactree.Error, "radius_m: must not be negative"):
            self.model.query([0, 0, 0], radius_m=-1)

    def test_other_threads_run_meanwhile(self):
        positions = probes(100_000)
        self.assertTrue(runs_beside(lambda: self.model.query(positions)))
        self.assertFalse(runs_beside(lambda: None))

    def test_ctrl_c_ends_query(self):
        positions = np.tile(probes(1000), (1000, 1))
        with self.assertRaises(KeyboardInterrupt), signal_during("query"):
            self.model.query(positions)


class Info(Folder):
    def test_equals_tool(self):
        self.run_tool("info", self.blob, "--json", "info.json")
        wanted = self.read("info.json")
        del wanted["signature"]
        self.assertEqual(self.model.info, wanted)
        self.assertEqual(len(self.model), wanted["points"])
        self.assertEqual(self.model.name, wanted["name"])
        np.testing.assert_array_equal(self.model.bounds_m, [wanted["bounds_min_m"], wanted["bounds_max_m"]])

    def test_size_warning_equals_tool(self):
        self.run_tool("build", "ball.csv", "--unit", "mm", "-o", "tiny.blob")
        said = self.run_tool("info", "tiny.blob").stderr
        warnings = tactree.load(self.path / "tiny.blob").info["warnings"]
        self.assertEqual(len(warnings), 1)
        self.assertIn(warnings[0].removeprefix(str(self.path) + "/"), said)

    def test_points_equal_tool(self):
        self.run_tool("info", self.blob, "--points", "points.csv")
        table = np.loadtxt(self.path / "points.csv", delimiter=",", skiprows=1).astype(np.float32)
        np.testing.assert_array_equal(self.model.points, table[:, 1:4])
        np.testing.assert_array_equal(self.model.normals, table[:, 4:7])

    def test_arrays_outlive_model_read_only(self):
        model = tactree.load(self.blob)
        self.assertTrue(np.shares_memory(model.points, model.points))
        self.assertTrue(np.shares_memory(model.data, model.data))
        data, points = model.data, model.points
        for array in (data, points, model.normals):
            with self.assertRaises(ValueError):
                array[0] = 0
        sums = int(data.astype(np.int64).sum()), float(points.sum())
        del model
        gc.collect()
        self.assertEqual((int(data.astype(np.int64).sum()), float(points.sum())), sums)
        self.assertEqual(data.tobytes(), self.blob.read_bytes())

    def test_saves_and_reads_bytes(self):
        self.model.save(self.path / "copy.blob")
        self.assertEqual((self.path / "copy.blob").read_bytes(), self.blob.read_bytes())
        self.assertEqual(tactree.Model.from_bytes(self.blob.read_bytes()).info["checksum"], self.model.info["checksum"])
        with self.assertRaisesRegex(tactree.FileError, "no/such.blob"):
            self.model.save("no/such.blob")


class Refusals(Folder):
    def test_errors_equal_tool(self):
        damaged = bytearray(self.blob.read_bytes())
        damaged[len(damaged) // 2] ^= 1
        (self.path / "damaged.blob").write_bytes(damaged)
        (self.path / "short.blob").write_bytes(damaged[:1000])
        (self.path / "text.blob").write_text("x,y,z\n")
        sentences = set()
        for name in ("damaged.blob", "short.blob", "text.blob", "missing.blob"):
            file = self.path / name
            run = self.run_tool("info", file)
            self.assertEqual(run.returncode, 1)
            with self.assertRaises(tactree.FileError) as refused:
                tactree.load(file)
            self.assertEqual(str(refused.exception), tool_error(run))
            self.assertIsInstance(refused.exception, tactree.Error)
            sentences.add(str(refused.exception))
        self.assertEqual(len(sentences), 4)
        with self.assertRaises(tactree.FileError) as refused:
            tactree.Model.from_bytes(bytes(damaged), "memory")
        self.assertIn("memory", str(refused.exception))


if __name__ == "__main__":
    unittest.main(verbosity=2)
