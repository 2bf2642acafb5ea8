#!/usr/bin/env python3
"""examples/touch displays the force of a simulated board.

usage: touch_test.py TACTREE TOUCH
"""
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from served_board import ServedBoard, build_ball  # noqa: E402

tactree, touch = (pathlib.Path(name).resolve() for name in sys.argv[1:])
with tempfile.TemporaryDirectory() as folder:
    blob = build_ball(tactree, pathlib.Path(folder))
    with ServedBoard(tactree, blob) as port:
        run = subprocess.run([touch, port, "3"], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        lines = run.stdout.splitlines()
        assert any("=" in line for line in lines), run.stdout
    missing = subprocess.run([touch, "/dev/no-such-port"], capture_output=True, text=True)
    assert missing.returncode == 1 and "/dev/no-such-port" in missing.stderr, missing.stderr
print(f"{len(lines)} lines")
