"""docs/RESULTS.md with its plots (docs/RESULTS/), docs/FIGURES.md, and the figures of docs/COLLECTIONS.md and SHARE.md."""
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPACINGS = ("0.0166666667", "0.0025")  # m: 90 601 and 4 004 001 points
POINTS = 5000000


def output_of(*command):
    done = subprocess.run([str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"generate: {' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr}")
    return done.stdout.strip()


def results(build):
    """The page below its title. A target that is missed is named as missed in it."""
    output_of(ROOT / "scripts/install-deps", "models")
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder, "RESULTS.md")
        output_of(build / "tools/cli/tactree", "evaluate", "--report", page)
        text = page.read_text().split("\n", 1)[1].strip()
        for plot in pathlib.Path(folder, "RESULTS").iterdir():
            (ROOT / "docs/RESULTS" / plot.name).write_bytes(plot.read_bytes())
    return "\n\n".join([text, "## Outside of raw clouds", output_of(build / "bench/orientation_bench"),
                        "## Stray points", output_of(build / "bench/stray_bench")])


def cpu_name():
    return next((line.split(": ", 1)[1] for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
                 if line.startswith("model name")), "unknown")


def machine():
    return f"Machine: {cpu_name()}, {os.cpu_count()} cores."


def figures(build):
    compiler = output_of(os.environ.get("CXX", "g++"), "--version").splitlines()[0]
    nearest = build / "bench/nearest_bench"
    return "\n\n".join([
        f"{machine()} Compiler: {compiler}, `-O2` for both.",
        "## Nearest point within two spacings, compared with nanoflann",
        "Surface z = cos x + cos y, 5 m x 5 m. The path of the hand follows the surface and hovers above it; random probes\n"
        "are near it. nanoflann searches the same float32 points, at most 10 in a leaf. Below a ratio of 1, Tactree is "
        "better.",
        *(output_of(nearest, "--spacing", spacing, "--instructions") for spacing in SPACINGS),
        "## From a scan to a blob",
        output_of(ROOT / "bench/build_bench", "--points", POINTS, "--tactree", build / "tools/cli/tactree"),
        "## Encoders of a Linux board", output_of(ROOT / "bench/edge_rates")])


def page(build):
    return output_of(ROOT / "bench/page_bench", "--tactree", build / "tools/cli/tactree")


def collections(build):
    return "\n\n".join([machine(), output_of(ROOT / "bench/collection_bench", "--tactree", build / "tools/cli/tactree")])


def rates(build):
    return "\n\n".join([machine(), output_of(ROOT / "bench/share_bench", "--tactree", build / "tools/cli/tactree")])
