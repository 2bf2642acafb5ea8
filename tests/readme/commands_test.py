"""The commands in README.md do what it says: all of them in order, in one folder, with the files it shows.

usage: commands_test.py TACTREE README
"""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

TACTREE, README = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
del sys.argv[1:3]
TEXT = README.read_text()
# What a user brings along: name -> radius of a ball, m.
SCANS = {"statue.ply": 0.03, "lid.ply": 0.02}


def ball(radius, spacing=1e-3):
    """An ASCII PLY, points with normals and colours: one half red, the other grey."""
    count = round(4 * math.pi * radius**2 / (0.7 * spacing)**2)
    names = [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    names += [f"property uchar {name}" for name in ("red", "green", "blue")]
    rows = ["ply", "format ascii 1.0", f"element vertex {count}", *names, "end_header"]
    for i in range(count):
        z, turn = 1 - (2 * i + 1) / count, i * math.pi * (3 - math.sqrt(5))
        n = (math.sqrt(1 - z * z) * math.cos(turn), math.sqrt(1 - z * z) * math.sin(turn), z)
        colour = "250 10 5" if n[0] > 0 else "120 120 120"
        rows.append(" ".join(f"{v:.8g}" for v in [radius * c for c in n] + list(n)) + " " + colour)
    return "\n".join(rows) + "\n"


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        for name, radius in SCANS.items():
            (cls.path / name).write_text(ball(radius))
        for name, content in re.findall(r"`([\w.]+\.json)`:\n\n```json\n(.*?)```", TEXT, re.DOTALL):
            (cls.path / name).write_text(content)
        (cls.path / "bin").mkdir()
        (cls.path / "bin" / "tactree").symlink_to(TACTREE)

    def run_line(self, line):
        environment = {**os.environ, "PATH": f"{self.path / 'bin'}:{os.environ['PATH']}"}
        return subprocess.run(["bash", "-c", line], cwd=self.path, env=environment, capture_output=True,
                              text=True, check=False)

    def read(self, name):
        return json.loads((self.path / name).read_text())

    def test_every_command_works(self):
        lines = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL)
                 for line in block.splitlines()]
        self.assertGreater(len(lines), 8)
        for line in lines:
            done = self.run_line(line)
            self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")
        for name in re.findall(r"--(?:plot|report|json) (\S+)", " ".join(lines)):
            self.assertGreater((self.path / name).stat().st_size, 100, name)

        self.run_line("tactree info felt.blob --json felt.json")
        self.assertEqual(len(self.read("felt.json")["material_list"]), 2)
        bodies = self.read("scene-run.json")["bodies"]
        self.assertEqual([pathlib.Path(body["blob"]).name for body in bodies], ["statue.blob", "lid.blob"])
        self.assertGreater(bodies[0]["contact_ticks"], 0)
        self.assertIn("shapes", self.read("evaluation.json"))


if __name__ == "__main__":
    unittest.main()
