"""The commands of README.md and docs/COMMANDS.md work: all of them in order, in one folder, with the files they show.

usage: commands_test.py TACTREE PAGE... CLASS      CLASS: Commands, LargeScan or ServedCommands
"""
import json
import math
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

TACTREE, *PAGES = (pathlib.Path(argument).resolve() for argument in sys.argv[1:-1])
del sys.argv[1:-1]
TEXT = "\n".join(page.read_text() for page in PAGES)
# The reader's own scans: name -> radius of a ball, m.
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


def figure(height, across=1500):
    """A coloured half spindle that stands on its flat, lowest y, with `across` points on its base."""
    rows = []
    add = rows.append
    golden = math.pi * (3 - math.sqrt(5))
    radius = height / 3
    for i in range(across):
        r = radius * math.sqrt((i + 0.5) / across)
        add((r * math.cos(i * golden), 0.0, r * math.sin(i * golden), 0, -1, 0))
    for i in range(6 * across):
        y = (i + 0.5) / (6 * across)
        r = math.sqrt(1 - y * y)
        n = (r * math.cos(i * golden) / radius, y / height, r * math.sin(i * golden) / radius)
        add((radius * r * math.cos(i * golden), height * y, radius * r * math.sin(i * golden),
             *(c / math.hypot(*n) for c in n)))
    names = [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    names += [f"property uchar {name}" for name in ("red", "green", "blue")]
    lines = [" ".join(f"{v:.8g}" for v in row) + (" 250 10 5" if row[2] > 0 else " 120 120 120") for row in rows]
    return "\n".join(["ply", "format ascii 1.0", f"element vertex {len(rows)}", *names, "end_header", *lines]) + "\n"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def prompt_lines(block):
    return [line.removeprefix("$ ") for line in block.splitlines() if line.startswith("$ ")]


class InAFolder(unittest.TestCase):
    scans = staticmethod(lambda: {name: ball(radius) for name, radius in SCANS.items()})

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        for name, content in cls.scans().items():
            (cls.path / name).write_text(content)
        for name, content in re.findall(r"`([\w.]+)`(?: [^`:]*)?:\n\n```(?:json|csv)\n(.*?)```", TEXT, re.DOTALL):
            (cls.path / name).write_text(content)
        cls.environment = {**os.environ, "PATH": cls.path_of_reader()}

    @classmethod
    def path_of_reader(cls):
        """As the README sets it in the folder of the project, whose build may have another name here."""
        (line,) = re.findall(r"^export PATH=.*$", TEXT, re.MULTILINE)
        project = cls.path / "project"
        (project / "build").mkdir(parents=True)
        (project / "build" / "host-gcc").symlink_to(TACTREE.parents[2])
        return subprocess.run(["bash", "-c", f'{line}; printf %s "$PATH"'], cwd=project, capture_output=True, text=True,
                              check=True).stdout

    @classmethod
    def run_line(cls, line):
        return subprocess.run(["bash", "-c", line], cwd=cls.path, env=cls.environment, capture_output=True,
                              text=True, check=False)

    @classmethod
    def succeeds(cls, line):
        done = cls.run_line(line)
        if done.returncode != 0:
            raise AssertionError(f"{line}\n{done.stdout}{done.stderr}")
        return done.stdout

    def read(self, name):
        return json.loads((self.path / name).read_text())


class Commands(InAFolder):
    def test_every_command_works(self):
        lines = [line for block in blocks("sh") for line in block.splitlines()]
        self.assertGreater(len(lines), 15)
        for line in lines:
            self.succeeds(line)
        for name in re.findall(r"(?:--(?:plot|report|json|preview|trace|html)|>) (\S+)", " ".join(lines)):
            self.assertGreater((self.path / name).stat().st_size, 100, name)

        self.succeeds("tactree info felt.blob --json felt.json")
        self.assertEqual(len(self.read("felt.json")["material_list"]), 2)
        bodies = self.read("scene-run.json")["bodies"]
        self.assertEqual([pathlib.Path(body["blob"]).name for body in bodies], ["statue.blob", "lid.blob"])
        self.assertGreater(bodies[0]["contact_ticks"], 0)
        self.assertGreater(self.read("evaluation.json")["scans"]["statue.ply"]["slides"]["ticks"], 1000)
        self.assertEqual(len((self.path / "answers.csv").read_text().splitlines()), 3)


class LargeScan(Commands):
    """Of a metre, with y up: the commands suit any size."""
    scans = staticmethod(lambda: {"statue.ply": figure(1.6), "lid.ply": figure(0.5)})


class ServedCommands(InAFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The commands that write the files named by the served ones, or by a later one of these.
        named = {word for block in blocks("console") for line in prompt_lines(block) for word in line.split()}
        writers = []
        for line in reversed([line for block in blocks("sh") for line in block.splitlines()]):
            if named.intersection(re.findall(r"(?:-o|--colours|--trace|--record|>) (\S+)", line)):
                writers.append(line)
                named.update(line.split())
        for line in reversed(writers):
            cls.succeeds(line)

    def start(self, line, expected):
        """A command that runs until it is ended; its first line of output matches `expected`."""
        process = subprocess.Popen(shlex.split(line, comments=True), cwd=self.path, env=self.environment,
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)  # cleanups run in reverse order, also if the test fails
        first = process.stdout.readline()
        self.assertRegex(first, expected, line)
        return process, first

    def end(self, process, line):
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(), 0, line)

    def shows_page(self, line):
        line = re.sub(r"(tactree view \S+)", r"\1 --page-port 0", line)
        process, first = self.start(line, r"http://\S+:\d+/")
        try:
            with urllib.request.urlopen(re.search(r"http://\S+:\d+/", first)[0]) as answer:
                self.assertEqual(answer.status, 200)
        except urllib.error.HTTPError as error:  # a program that was built without npm has no page
            self.assertEqual(error.code, 404)
        self.end(process, line)

    def test_serves_every_page(self):
        lines = [line for block in blocks("console") if "--serve" not in block for line in prompt_lines(block)]
        self.assertEqual(len(lines), 5)
        for line in lines:
            self.shows_page(line)

    def test_served_board_answers_every_command(self):
        (block,) = [block for block in blocks("console") if "--serve" in block]
        shown = re.search(r"^serving at (\S+)$", block, re.MULTILINE)[1]
        serve, *lines = prompt_lines(block)
        # In lock-step, so that a slow machine loses no link.
        board, first = self.start(serve.removesuffix("&") + "--lock-step", r"^serving at \S+$")
        port = first.removeprefix("serving at ").strip()
        self.assertGreater(len(lines), 5)
        for line in lines:
            self.assertIn(shown, line)
            line = line.replace(shown, port)
            if line.startswith("tactree view"):
                self.shows_page(line)
            else:
                self.succeeds(line)
        self.end(board, serve)


if __name__ == "__main__":
    unittest.main(verbosity=2)
