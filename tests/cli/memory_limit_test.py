"""The memory of a build: what it takes, and clouds that are too large for it, which are thinned while they are read.

usage: memory_limit_test.py TACTREE
"""
import math
import pathlib
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import ToolFolder, sphere  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class MemoryLimit(ToolFolder):
    tool = TACTREE
    LIMIT = 32 << 20

    def build_large(self, *arguments, limit="32M"):
        # The peak memory of a program begins with that of the process that started it: here a small one.
        command = ["sh", "-c", '"$@"; exit', "sh", TACTREE, "build", "large.xyz", "-o", "o.blob",
                   "--memory-limit", limit, *arguments]
        done = subprocess.run(command, cwd=self.path, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def test_thins_large_cloud_and_takes_no_more(self):
        self.write("large.xyz", sphere(200_000, 0.05))
        done = self.build_large("--report", "r.json")
        report = self.read("r.json")
        thinned = report["dropped"]["beyond_memory_limit"]
        self.assertEqual(report["inputs"][0]["points"], 200_000)
        self.assertEqual(report["input_points"], 200_000)
        self.assertLess(200_000 - thinned, 30_000)
        self.assertGreater(200_000 - thinned, 5_000)
        self.assertLessEqual(report["stages"][-1]["peak_rss_bytes"], self.LIMIT)
        self.assertRegex(done.stdout, "note .* of 200000 points, more than the memory limit allows, the first in each")
        one = pathlib.Path(self.path, "o.blob").read_bytes()
        self.build_large("--threads", "1")
        self.assertEqual(pathlib.Path(self.path, "o.blob").read_bytes(), one)

    def test_wide_spacing_takes_a_quarter_of_the_memory(self):
        points = 400_000
        self.write("large.xyz", sphere(points, 0.05))
        mean_distance = (4 * math.pi / points) ** 0.5 * 0.05
        self.build_large("--threads", "2", "--spacing", str(3 * mean_distance), "--report", "r.json", limit="1G")
        report = self.read("r.json")
        self.assertLess(report["output_points"], points / 5)
        program = 14 << 20
        self.assertLessEqual((report["peak_rss_bytes"] - program) / points, 56)

    def test_names_limit_where_spacing_is_too_fine_for_it(self):
        self.write("large.xyz", sphere(100_000, 0.05))
        done = self.build_large("--spacing", "0.0006")
        self.assertRegex(done.stderr, "was thinned to fit in the memory, and is too coarse .*raise --memory-limit")

    def test_files_share_limit_by_size(self):
        self.write("large.xyz", sphere(100_000, 0.05))
        self.write("small.xyz", sphere(1_500, 0.01))
        done = self.run_tool("build", "large.xyz", "small.xyz", "-o", "o.blob", "--memory-limit", "32M")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("large.xyz: of 100000 points", done.stdout)
        self.assertIn("small.xyz: of 1500 points", done.stdout)

    def test_refuses_too_little(self):
        for text in ("31M", "0", "-1", "many", ""):
            done = self.run_tool("build", "s.xyz", "-o", "y", "--memory-limit", text)
            self.assertEqual(done.returncode, 2, text)
            self.assertIn("--memory-limit", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
