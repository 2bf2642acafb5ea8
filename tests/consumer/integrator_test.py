"""The programs of examples/integrator link no heap, and its board header is as short as docs/PORTING.md states.

usage: integrator_test.py SOURCES BUILD
"""
import pathlib
import subprocess
import sys

SOURCES, BUILD = map(pathlib.Path, sys.argv[1:])
LINES_MAX = 150

lines = len((SOURCES / "hc3_board.hpp").read_text().splitlines())
assert lines < LINES_MAX, f"hc3_board.hpp has {lines} lines"
for program in ("hc3-main.elf", "hc3-conformance.elf"):
    symbols = subprocess.run(["arm-none-eabi-nm", BUILD / program], check=True, capture_output=True,
                             text=True).stdout.split()
    assert any("Controller4step" in s for s in symbols) == (program == "hc3-main.elf")
    for heap in ("malloc", "_malloc_r", "_Znwj"):
        assert heap not in symbols, f"{program}: {heap}"
print(f"hc3_board.hpp implements the contracts in {lines} lines")
