"""The project in docs/LIBRARY.md, as a reader copies it: builds against the installed library, and works.

usage: library_test.py PAGE PREFIX CXX SEEDS
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from served_board import ServedBoard, build_ball  # noqa: E402

PAGE, PREFIX, CXX, SEEDS = sys.argv[1:5]
del sys.argv[1:5]
TACTREE = pathlib.Path(PREFIX, "bin/tactree")
FILES = re.findall(r"`([\w.]+)`:\n\n```\w+\n(.*?)```", pathlib.Path(PAGE).read_text(), re.DOTALL)


class Project(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        for name, content in FILES:
            (cls.folder / name).write_text(content)
        cls.build = cls.folder / "build"
        for command in (["-S", cls.folder, "-B", cls.build, f"-DCMAKE_CXX_COMPILER={CXX}", f"-DCMAKE_PREFIX_PATH={PREFIX}",
                         "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wconversion"],
                        ["--build", cls.build]):
            done = subprocess.run(["cmake", *command], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise AssertionError(done.stdout + done.stderr)

    def run_program(self, name, *arguments):
        return subprocess.run([self.build / name, *arguments], capture_output=True, text=True, check=False)

    def test_page_has_every_file(self):
        self.assertEqual([name for name, _ in FILES], ["CMakeLists.txt", "surface.cpp", "watch.cpp"])

    def test_surface(self):
        done = self.run_program("surface", pathlib.Path(SEEDS, "kOk.surface_materials"))
        self.assertRegex(done.stdout, r"^the surface is 1\.0 mm below the probe; normal \(")
        self.assertEqual(done.returncode, 0)

    def test_surface_refuses_damage(self):
        done = self.run_program("surface", pathlib.Path(SEEDS, "kBadChecksum.bit"))
        self.assertRegex(done.stdout, r"^refused: \S")
        self.assertEqual(done.returncode, 1)

    def test_watch(self):
        with ServedBoard(TACTREE, build_ball(TACTREE, self.folder)) as port:
            done = self.run_program("watch", port)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 10)
        self.assertRegex(done.stdout, r"(?m)^state 2, probe at z = -?\d+\.\d mm, force 0\.00 N$")

    def test_watch_without_board(self):
        done = self.run_program("watch", "/dev/no-such-port")
        self.assertEqual(done.returncode, 1)
        self.assertIn("/dev/no-such-port", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
