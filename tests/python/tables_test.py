"""tactree.read_trace and read_recording: the files of tactree simulate and tactree record.

usage: tables_test.py TACTREE
"""
import csv
import pathlib
import sys
import unittest
import zipfile

import numpy as np
import tactree

from clouds import ModelFolder, ServedBoard

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class Folder(ModelFolder):
    tool = TACTREE

    def expect_refusal(self, read, name, *words):
        with self.assertRaises(tactree.FileError) as refused:
            read(self.path / name)
        for word in (name, *words):
            self.assertIn(word, str(refused.exception))

    def spoil(self, name, old, new):
        text = (self.path / name).read_text()
        self.assertIn(old, text)
        return self.write("spoilt.csv", text.replace(old, new, 1))


class Trace(Folder):
    def setUp(self):
        self.run_tool("simulate", self.blob, "--seconds", "0.3", "--trace", "run.csv")

    def test_equals_table_of_run(self):
        trace = tactree.read_trace(self.path / "run.csv")
        run = tactree.Simulation(self.model).run(seconds=0.3)
        self.assertEqual(trace.dtype, run.dtype)
        for name in run.dtype.names:
            if run.dtype[name] == np.float64:  # nine digits
                np.testing.assert_allclose(trace[name], run[name], rtol=1e-8)
            else:
                np.testing.assert_array_equal(trace[name], run[name])
        self.assertTrue(trace["in_contact"].any())
        self.assertEqual(tactree.vectors(trace, "velocity").shape, (300, 3))

    def test_refuses_other_files(self):
        self.expect_refusal(tactree.read_trace, "missing.csv")
        self.expect_refusal(tactree.read_trace, self.write("x.csv", "x,y,z\n1,2,3\n"), "no column t_s",
                            "give a file written by simulate --trace")
        self.expect_refusal(tactree.read_trace, self.spoil("run.csv", ",active,", ",asleep,"), "line 2", "'asleep'")
        self.expect_refusal(tactree.read_trace, self.spoil("run.csv", ",0,active,", ",7,active,"), "in_contact: 7")
        self.expect_refusal(tactree.read_trace, self.spoil("run.csv", ",0,active,", ",active,"), "line 2")


class Recording(Folder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with ServedBoard(TACTREE, cls.blob) as port:
            for name in ("board.csv", "board.npz"):
                done = cls.run_tool("record", "--port", port, "--seconds", "0.5", "--arm", "-o", name)
                assert done.returncode == 0, done.stderr

    def test_both_formats_have_all_rows(self):
        for name in ("board.csv", "board.npz"):
            table = tactree.read_recording(self.path / name)
            self.assertEqual(len(table), 500)
            states = {tactree.STATES[state] for state in table["state"]}
            self.assertEqual(states - {"armed"}, {"idle", "active"})
            np.testing.assert_array_equal(np.diff(table["tick"]), 1)
            self.assertEqual(float(table["t_s"][-1]), 0.499)
            self.assertGreater(np.abs(tactree.vectors(table, "force")).max(), 0.1)

    def test_cut_csv_ends_with_whole_row(self):
        text = (self.path / "board.csv").read_text()
        name = self.write("board.csv.incomplete", text[:-10])
        self.assertEqual(len(tactree.read_recording(self.path / name)), 499)

    def test_reads_every_csv_value(self):
        table = tactree.read_recording(self.path / "board.csv")
        with (self.path / "board.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(table.dtype.names), list(rows[0]))
        for name in table.dtype.names:
            column = [row[name] for row in rows]
            if name == "state":
                column = [tactree.STATES.index(value) for value in column]
            np.testing.assert_array_equal(table[name], np.array(column, float).astype(table.dtype[name]))

    def test_reads_every_npz_array(self):
        table = tactree.read_recording(self.path / "board.npz")
        with np.load(self.path / "board.npz") as arrays:
            self.assertEqual({*arrays.files}, {*table.dtype.names, "state_names"})
            for name in table.dtype.names:
                np.testing.assert_array_equal(table[name], arrays[name])

    def test_reads_files_without_newer_columns(self):
        self.spoil("board.csv", "added_force_x_N", "other")
        with np.load(self.path / "board.npz") as arrays:
            np.savez(self.path / "older.npz", **{name: arrays[name] for name in arrays.files if name != "added_force_x_N"})
        for name in ("spoilt.csv", "older.npz"):
            table = tactree.read_recording(self.path / name)
            self.assertTrue(np.isnan(table["added_force_x_N"]).all())
            self.assertFalse(np.isnan(table["added_force_y_N"]).any())

    def test_refuses_other_files(self):
        read = tactree.read_recording
        self.expect_refusal(read, "missing.npz", "give a file written by tactree record")
        self.expect_refusal(read, self.write("text.npz", "text"))
        self.expect_refusal(read, self.spoil("board.csv", ",idle,", ",asleep,"), "line 2", "'asleep'")
        self.expect_refusal(read, self.spoil("board.csv", "overruns", "under"), "no column overruns")
        np.savez(self.path / "other.npz", x=np.zeros(3))
        self.expect_refusal(read, "other.npz", "has no array t_s")
        data = (self.path / "board.npz").read_bytes()
        (self.path / "cut.npz").write_bytes(data[:len(data) // 2])
        self.expect_refusal(read, "cut.npz")
        with np.load(self.path / "board.npz") as arrays:
            fields = {name: arrays[name] for name in arrays.files}
        np.savez(self.path / "short.npz", **{**fields, "tick": fields["tick"][1:]})
        self.expect_refusal(read, "short.npz", "differ in length")
        np.savez(self.path / "states.npz", **{**fields, "state_names": fields["state_names"][::-1]})
        self.expect_refusal(read, "states.npz", "state_names")
        np.savez(self.path / "pickle.npz", **{**fields, "tick": np.array([{}] * 500, dtype=object)})
        self.expect_refusal(read, "pickle.npz")
        self.assertTrue(zipfile.is_zipfile(self.path / "pickle.npz"))

    def test_vectors_names_existing_columns(self):
        table = tactree.read_recording(self.path / "board.csv")
        with self.assertRaisesRegex(tactree.Error, "no columns torque_x.*the columns are t_s, tick"):
            tactree.vectors(table, "torque")


if __name__ == "__main__":
    unittest.main(verbosity=2)
