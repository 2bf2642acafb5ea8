"""Commands of a cross build folder, as clang takes them. For scripts/compile-with-clang and check-style."""
import pathlib
import re
import shlex
import subprocess

TARGETS = {"arm-none-eabi-g++": "thumbv7em-none-eabihf", "riscv64-unknown-elf-g++": "riscv32-unknown-elf"}
# Of gcc only.
DROPPED = re.compile(r"^-(fcallgraph-info|misa-spec|fno-tree-loop-distribute-patterns)")


def is_cross(entry):
    return pathlib.Path(shlex.split(entry["command"])[0]).name in TARGETS


def system_headers(command):
    """The folders in which gcc finds the C++ library, as options."""
    done = subprocess.run([*command, "-E", "-v", "-x", "c++", "/dev/null", "-o", "/dev/null"],
                          capture_output=True, text=True, check=True)
    listed = re.search(r"search starts here:\n(.*?)\nEnd of search list", done.stderr, re.S).group(1)
    folders = [line.strip() for line in listed.splitlines() if line.startswith(" ")]
    return [flag for folder in folders if "/lib/gcc/" not in folder or "c++" in folder
            for flag in ("-isystem", folder)]


class ClangCommands:
    """The entries of one build folder: one compiler and one processor."""

    def __init__(self):
        self.headers = None

    def of(self, entry):
        """The command of an entry of compile_commands.json; its output goes to /dev/null."""
        compiler, *flags = shlex.split(entry["command"])
        if self.headers is None:
            cpu = [flag for flag in flags if flag.startswith("-m")]
            self.headers = system_headers([compiler, *cpu, *[f for f in flags if f == "-nostdinc++"]])
        kept = [flag for flag in flags if not DROPPED.match(flag)]
        kept[kept.index("-o") + 1] = "/dev/null"
        return ["clang++", "--target=" + TARGETS[pathlib.Path(compiler).name], "-nostdinc++", *self.headers,
                *kept]
