"""Compiler flags that the library cannot work with are refused by its headers.

usage: compiler_flags_test.py COMPILER INCLUDE_FOLDER
"""
import subprocess
import sys
import unittest

INCLUDE = sys.argv.pop()
COMPILER = sys.argv.pop()


class CompilerFlags(unittest.TestCase):
    def compile(self, *flags):
        """Exit code and messages."""
        done = subprocess.run([COMPILER, "-x", "c++", "-fsyntax-only", "-I", INCLUDE, *flags, "-"],
                              input="#include <tactree/core/math/vec3.hpp>\n", capture_output=True, text=True)
        return done.returncode, done.stderr

    def test_cpp20_compiles(self):
        self.assertEqual(self.compile("-std=c++20"), (0, ""))

    def test_refuses_cpp17_with_hint(self):
        code, text = self.compile("-std=c++17")
        self.assertNotEqual(code, 0)
        self.assertIn("compile as C++20 (-std=c++20)", text)

    def test_refuses_fast_math(self):
        for flags in (["-ffast-math"], ["-Ofast"]):
            code, text = self.compile("-std=c++20", *flags)
            self.assertNotEqual(code, 0)
            self.assertIn("compile without -ffast-math", text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
