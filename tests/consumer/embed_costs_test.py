"""Configures firmware with and without the host tool that writes the costs of a tick into the images.

usage: embed_costs_test.py SOURCES WORK
"""
import pathlib
import shutil
import subprocess
import sys
import unittest

SOURCES, WORK = map(pathlib.Path, sys.argv[1:3])
MISSING = WORK / "no" / "tactree"


class EmbedCosts(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)

    def configure(self, toolchain, *options):
        done = subprocess.run(
            ["cmake", "-S", SOURCES, "-B", WORK / toolchain, "-G", "Ninja", "-DTACTREE_BUILD_FIRMWARE=ON",
             "-DTACTREE_BUILD_TESTS=OFF", f"-DCMAKE_TOOLCHAIN_FILE={SOURCES}/toolchains/{toolchain}.cmake",
             *options], capture_output=True, text=True, check=False)
        return done.returncode, " ".join(done.stderr.split())

    def commands(self, toolchain):
        return (WORK / toolchain / "build.ninja").read_text()

    def test_board_with_timing_needs_tool(self):
        code, message = self.configure("cortex-m4f", f"-DTACTREE_HOST_TOOL={MISSING}")
        self.assertEqual(code, 1)
        self.assertIn(f"netduinoplus2: the costs of a tick cannot be written into the image: {MISSING} "
                      "does not exist", message)
        self.assertIn("cmake --build --preset host-gcc --target tactree_cli", message)
        self.assertIn("-DTACTREE_EMBED_COSTS=OFF", message)

    def test_without_costs_when_switched_off(self):
        code, message = self.configure("cortex-m4f", f"-DTACTREE_HOST_TOOL={MISSING}",
                                       "-DTACTREE_EMBED_COSTS=OFF")
        self.assertEqual(code, 0, message)
        self.assertNotIn("--embed", self.commands("cortex-m4f"))

    def test_image_depends_on_tool(self):
        tool = WORK / "tactree"
        tool.write_text("#!/bin/sh\n")
        tool.chmod(0o755)
        code, message = self.configure("cortex-m4f", f"-DTACTREE_HOST_TOOL={tool}")
        self.assertEqual(code, 0, message)
        self.assertIn("--embed", self.commands("cortex-m4f"))
        for board in ("netduinoplus2", "stm32f405"):
            needs = subprocess.run(["ninja", "-C", WORK / "cortex-m4f", "-t", "query", f"firmware/{board}.elf"],
                                   capture_output=True, text=True, check=True).stdout
            self.assertIn(str(tool), needs)

    def test_board_without_timing_needs_none(self):
        code, message = self.configure("cortex-m7", f"-DTACTREE_HOST_TOOL={MISSING}")
        self.assertEqual(code, 0, message)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
