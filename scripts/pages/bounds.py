"""Tables of docs/BOUND.md: the bound of a tick on each board with the highest rate, and the share of it that a search
reaches.
"""
import json
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MESH = "/usr/share/glmark2/models/bunny.obj"
BOARDS = {"netduinoplus2": "cortex-m4f", "stm32f405": "cortex-m4f", "mps2-an386": "cortex-m4f",
          "mps2-an505": "cortex-m33", "mps2-an500": "cortex-m7"}
CORES = {"cortex-m4f": "M4F", "cortex-m33": "M33", "cortex-m7": "M7"}
RATES = (1000, 2000, 4000)


def run(*command, codes=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=ROOT)
    if done.returncode not in codes:
        raise SystemExit(f"generate: {' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr}")
    return done.stdout


def spaced(number):
    return f"{number:,.0f}".replace(",", " ")


def build_images():
    for preset in sorted(set(BOARDS.values())):
        run("cmake", "--preset", preset)
        run("cmake", "--build", "--preset", preset)


def bounds(build):
    """The table of the boards."""
    build_images()
    with tempfile.TemporaryDirectory() as folder:
        return bounds_in(build / "tools/cli/tactree", pathlib.Path(folder))


def bounds_in(tool, folder):
    blob, report = folder / "bunny.blob", folder / "bound.json"
    run(tool, "build", MESH, "--fit", "0.10", "--spacing", "0.0005", "-o", blob)
    rows = []
    for board, toolchain in BOARDS.items():
        cells = []
        for rate in RATES:
            # Exit code 1: the board cannot keep this rate.
            run(tool, "bound", ROOT / "build" / toolchain / "firmware" / f"{board}.elf", "--board", board, "--blob",
                blob, "--device", "premium", "--rate", rate, "--json", report, codes=(0, 1))
            bound = json.loads(report.read_text())
            cells.append(f"{spaced(bound['instructions'])} / {spaced(bound['cycles'])}")
        estimate = " (estimate)" if bound["cycles_are_an_estimate"] else ""
        rows.append(f"| {board} ({CORES[toolchain]}) | {' | '.join(cells)} | {bound['rate_max_hz']:.0f} Hz{estimate} |")
    return "\n".join(["| board | 1 kHz | 2 kHz | 4 kHz | highest rate |", "|---|---|---|---|---|", *rows])


def shares(build):
    """The table of what a search finds."""
    build_images()
    output = run(build / "tests/bound/board_bound_test", "--gtest_filter=*FindsNoTick*")
    line = r"^(\S+), (\d+) Hz: worst tick found (\d+) instructions, bound (\d+)"
    worst = {}  # of the model of which the search found the largest share
    for board, rate, found, bound in re.findall(line, output, re.MULTILINE):
        row = int(found) / int(bound), int(found), int(bound)
        key = board, int(rate) // 1000
        worst[key] = max(worst.get(key, row), row)
    rows = [f"| {board} | {khz} kHz | {spaced(found)} | {spaced(bound)} | {100 * share:.0f} % |"
            for (board, khz), (share, found, bound) in worst.items()]
    if not rows:
        raise SystemExit("generate: the search printed nothing")
    return "\n".join(["| board | rate | worst tick found | bound | share |", "|---|---|---|---|---|", *rows])
