"""The snippets of docs/PYTHON.md work: all of them in order, in one interpreter and one folder.

usage: page_test.py TACTREE PAGE
"""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import tactree

from clouds import ServedBoard, ball

TACTREE, PAGE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
del sys.argv[1:3]
# (what the snippet prints according to the page or None, the snippet)
SNIPPETS = re.findall(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", PAGE.read_text(), re.DOTALL)
PORT = "/dev/ttyACM0"


class Page(unittest.TestCase):
    def test_every_snippet_in_order(self):
        self.assertGreater(len(SNIPPETS), 10)
        self.assertEqual(PAGE.read_text().count("```python"), len(SNIPPETS))
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        # What the reader has: a scan, a trace and a recording of the tool.
        points = np.array([p for p, _ in ball(4000, 0.03)])
        np.savetxt("statue.xyz", points)
        subprocess.run([TACTREE, "build", "statue.xyz", "--unit", "m", "-o", "statue.blob"], check=True, capture_output=True)
        subprocess.run([TACTREE, "simulate", "statue.blob", "--seconds", "0.5", "--trace", "rub.csv"], check=True,
                       capture_output=True)
        os.remove("statue.blob")
        names = {}
        printed = 0
        blob = pathlib.Path(folder.name, "statue.blob")
        with contextlib.ExitStack() as stack:
            port = None
            for code, shown in SNIPPETS:
                if PORT in code and port is None:
                    port = stack.enter_context(ServedBoard(TACTREE, blob))
                    subprocess.run([TACTREE, "record", "--port", port, "--seconds", "0.2", "-o", "session.npz"], check=True,
                                   capture_output=True)
                out = io.StringIO()
                with self.subTest(code=code), contextlib.redirect_stdout(out):
                    exec(compile(code.replace(PORT, port or PORT), str(PAGE), "exec"), names)
                if shown:
                    printed += 1
                    self.assertEqual(out.getvalue(), shown, code)
        self.assertGreater(printed, 5)

    def test_mentions_every_public_name(self):
        text = PAGE.read_text()
        for name in tactree.__all__:
            if not name.startswith("_"):
                self.assertIn(name, text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
