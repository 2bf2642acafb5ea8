"""A firmware outside the tree, with names of its own: its bound, the model for it, its image, and its run in an emulator.

usage: own_firmware_test.py TACTREE SOURCES BUILD PREFIX EMULATOR...
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

TACTREE, SOURCES, BUILD, PREFIX = sys.argv[1:5]
EMULATOR = sys.argv[5:]
OWN = pathlib.Path(SOURCES, "tests/consumer/own")
IMAGE = pathlib.Path(BUILD, "own.elf")


def tactree(*arguments):
    return subprocess.run([TACTREE, *map(str, arguments)], capture_output=True, text=True, check=False)


class OwnFirmware(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def done(self, *arguments):
        run = tactree(*arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout

    def model(self):
        points = self.folder / "plane.xyz"
        points.write_text("".join(f"{x} {y} 0\n" for x in range(60) for y in range(60)))
        blob = self.folder / "plane.blob"
        self.done("build", points, "--unit", "mm", "--for", IMAGE, "--rate", 500, "-o", blob, "--progress", "off")
        return blob

    def run_image(self, image):
        run = subprocess.run([*EMULATOR, image], capture_output=True, text=True, check=False)
        return [line for line in (run.stdout + run.stderr).splitlines() if not line.startswith("qemu-system")]

    def test_bound(self):
        report = self.folder / "bound.json"
        sources = [f"--sources={folder}" for folder in (SOURCES, f"{PREFIX}/include", OWN)]
        self.done("bound", IMAGE, "--entry", "control_loop_step", *sources, "--board", OWN / "own.json",
                  "--json", report)
        bound = json.loads(report.read_text())
        self.assertGreater(bound["cycles"], bound["instructions"])
        self.assertTrue(any(loop["file"].startswith("include/tactree/") or loop["file"].startswith("core/")
                            for loop in bound["loops"]))

        def instructions(entry):
            said = self.done("bound", IMAGE, "--entry", entry, *sources)
            return int(re.search(r"^instructions +(\d+)", said, re.M)[1])
        self.assertLess(instructions("tactree::core::Controller::step"), instructions("control_loop_step"))

    def test_refuses_unknown_entries_and_sources(self):
        sources = f"--sources={SOURCES}"
        none = tactree("bound", IMAGE, "--entry", "no_such_step", sources)
        self.assertEqual(none.returncode, 1)
        self.assertIn("has no function no_such_step", none.stderr)
        self.assertIn("is not a folder", tactree("bound", IMAGE, "--sources", self.folder / "none").stderr)
        self.assertIn("tactree_tick", tactree("bound", IMAGE, sources).stderr)

    def test_builds_the_model_for_its_room_and_rate(self):
        blob = self.model()
        self.assertLessEqual(blob.stat().st_size, 1 << 20)
        points = self.folder / "plane.xyz"
        fast = tactree("build", points, "--unit", "mm", "--for", IMAGE, "--rate", 20000, "-o", self.folder / "f.blob")
        self.assertEqual(fast.returncode, 1)
        self.assertIn("own renders this model at up to", fast.stderr)

    def test_runs_with_its_model(self):
        merged = self.folder / "merged.elf"
        self.done("image", IMAGE, self.model(), "--board", "own", "-o", merged)
        self.assertEqual(self.run_image(merged),
                         ["program intact", "memory holds", "too slow", "admitted", "idle", "fault recorded"])

    def test_notices_a_damaged_program(self):
        data = bytearray(IMAGE.read_bytes())
        at = data.index(b"program intact\n\0")
        data[at] ^= 0x20
        damaged = self.folder / "damaged.elf"
        damaged.write_bytes(data)
        self.assertIn("program damaged", self.run_image(damaged))
        self.assertIn("its checksum does not match", tactree("image", damaged, "-o", self.folder / "x.hex").stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
