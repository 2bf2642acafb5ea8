"""The pictures in docs/images that show the product in use."""
import os
import pathlib
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
INTO = ROOT / "docs/images"
MAX_BYTES = 450 * 1024
MESH = "/usr/share/glmark2/models/bunny.obj"
SHOWN = """| picture in `docs/images/` | shows |
|---|---|
| `page.png`, `page-both.png` | the page of `tactree view` in use, in a headless browser |
| `model.png` | a model as `tactree info --preview` draws it |
| `rub-surface.svg`, `rub-both.svg` | the force of a simulated hand |"""


def run(*command, cwd=None, **environment):
    done = subprocess.run([str(part) for part in command], cwd=cwd, env={**os.environ, **environment},
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"generate: {' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr}")


def pictures(build):
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        raise SystemExit("generate: chromium is missing (scripts/install-deps web)")
    tactree = build / "tools/cli/tactree"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(tactree, "build", MESH, "--axis", "y", "--fit", "0.10", "--spacing", "0.0005", "--progress", "off",
            "-o", folder / "bunny.blob", "--preview", INTO / "model.png")
        rub = [tactree, "simulate", "bunny.blob", "--device", "premium", "--rate", "1000", "--seconds", "10",
               "--script", "rub"]
        run(*rub, "--plot", INTO / "rub-surface.svg", cwd=folder)
        run(*rub, "--compare", "--plot", INTO / "rub-both.svg", cwd=folder)
        for file in [*(ROOT / "tests/web").glob("*.mjs"), *(ROOT / "tests/web").glob("package*.json")]:
            shutil.copy(file, folder)
        run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", cwd=folder)
        run("node", "pictures.mjs", folder / "bunny.blob", INTO, cwd=folder, TACTREE=str(tactree), CHROMIUM=browser)
    for picture in INTO.iterdir():
        if picture.stat().st_size > MAX_BYTES:
            raise SystemExit(f"generate: {picture} is too large")
    return SHOWN
