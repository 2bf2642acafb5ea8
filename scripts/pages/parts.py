"""Parts of the controller that can be used alone (examples/parts/): their code, and the size of each on a Cortex-M4F."""
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# File -> heading, functions that the program calls.
PARTS = {"query": ("Only the query", ("open", "distance_at")), "proxy": ("Only the proxy", ("force_at",)),
         "gate": ("Only the gate", ("limit", "command"))}
FLAGS = ["-mthumb", "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-std=c++20", "-O2", "-fno-exceptions",
         "-fno-rtti", "-fno-threadsafe-statics", "-fno-math-errno", "-fno-jump-tables", "-ffp-contract=off",
         "-ffunction-sections", "-fdata-sections"]


def run(*command, folder):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=folder, check=False)
    if done.returncode != 0:
        raise SystemExit(f"generate: {' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr}")
    return done.stdout


def code(root):
    """The code of each part, under its heading."""
    return "\n\n".join(f"#### {heading}\n\n```cpp\n{(root / f'examples/parts/{name}.cpp').read_text()}```"
                       for name, (heading, _) in PARTS.items())


def symbol_of(name, functions, folder):
    """Symbols of the functions of a part."""
    listed = run("arm-none-eabi-nm", "--defined-only", f"{name}.o", folder=folder).split()
    begins = tuple(f"_Z{len(function)}{function}" for function in functions)
    return [symbol for symbol in listed if symbol.startswith(begins)]


def size_of(name, functions, folder):
    """Bytes of code and constants, and of variables, of a program that consists of the part."""
    run("arm-none-eabi-g++", *FLAGS, "-I", ROOT / "core/include", "-c", ROOT / f"examples/parts/{name}.cpp", "-o", f"{name}.o",
        folder=folder)
    kept = [f"-Wl,-u,{symbol}" for symbol in symbol_of(name, functions, folder)]
    run("arm-none-eabi-g++", *FLAGS, "-nostdlib", "-nostartfiles", "-Wl,--gc-sections,-e,0", *kept, f"{name}.o", "libcore.a",
        "memory.o", "-lgcc", "-o", f"{name}.elf", folder=folder)
    text, data, bss = map(int, run("arm-none-eabi-size", f"{name}.elf", folder=folder).splitlines()[1].split()[:3])
    return text + data, data + bss


def sizes(_build):
    """The table of the parts."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        sources = sorted((ROOT / "core/src").rglob("*.cpp"))
        for number, source in enumerate(sources):
            run("arm-none-eabi-g++", *FLAGS, "-I", ROOT / "core/include", "-I", ROOT / "core/src", "-c", source, "-o", f"c{number}.o",
                folder=folder)
        run("arm-none-eabi-g++", *FLAGS, "-fno-builtin", "-fno-tree-loop-distribute-patterns", "-c",
            ROOT / "hal/runtime/src/memory.cpp", "-o", "memory.o", folder=folder)
        run("arm-none-eabi-ar", "rc", "libcore.a", *(f"c{number}.o" for number in range(len(sources))), folder=folder)
        rows = [(heading, *size_of(part, functions, folder)) for part, (heading, functions) in PARTS.items()]
    return "\n".join(["| part | flash, KiB | RAM, KiB, without the stack |", "|---|---|---|",
                      *(f"| {heading.lower()} | {flash / 1024:.1f} | {ram / 1024:.1f} |" for heading, flash, ram in rows)])
