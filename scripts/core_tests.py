"""Builds the tests of core/ with some sources compiled differently, for scripts/coverage and scripts/mutate.
Takes the commands from a build folder and writes nothing there.
"""
import json
import pathlib
import shlex
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = "tests/unit/core"  # of the build, with the programs
TESTS = ("core_test", "controller_test", "surface_test", "scene_test")


class Build:
    def __init__(self, folder, tests):
        self.folder = pathlib.Path(folder).resolve()
        if not (self.folder / "build.ninja").exists():
            raise SystemExit(f"{self.folder} is not a build folder (cmake --preset host-gcc)")
        subprocess.run(["cmake", "--build", self.folder, "--target", *tests], check=True,
                       stdout=subprocess.DEVNULL)
        entries = json.loads((self.folder / "compile_commands.json").read_text())
        self.compiles = {e["file"]: e["command"] for e in entries if "tactree_core.dir" in e["command"]}

    def compile(self, source, output, *flags, text=None):
        """Compiles a file of core/, or `text` in its place, with additional flags."""
        words = shlex.split(self.compiles[str(ROOT / source)])
        words = words[1:] if pathlib.Path(words[0]).name == "ccache" else words
        at = words.index("-o")
        words = words[:at] + words[at + 4:]  # -o OBJECT -c SOURCE
        what = ["-x", "c++", "-"] if text is not None else [str(ROOT / source)]
        include = ["-I", str((ROOT / source).parent)]
        return subprocess.run([*words, *include, *flags, "-o", str(output), *what], cwd=self.folder,
                              input=text, text=True, capture_output=True, check=False)

    def link(self, test, output, *added):
        """Links a test again, with objects that precede the library and so replace its own."""
        target = f"{FOLDER}/{test}"
        done = subprocess.run(["ninja", "-C", self.folder, "-t", "commands", "-s", target], check=True,
                              capture_output=True, text=True)
        steps = done.stdout.strip().splitlines()[-1].split(" && ")
        words = shlex.split(next(step for step in steps if f" -o {target} " in step))
        words[words.index("-o") + 1] = str(output)
        subprocess.run([words[0], *map(str, added), *words[1:]], cwd=self.folder, check=True)
