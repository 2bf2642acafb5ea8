"""scripts/check-image on the image of a board, and on budgets and graphs it must refuse.

usage: check_image_test.py IMAGE BOARD TOOLS FOLDER_WITH_CALLGRAPH...
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
IMAGE, BOARD, TOOLS, *FOLDERS = sys.argv[1:]


def check(*arguments, folders=(), image=IMAGE):
    done = subprocess.run([ROOT / "scripts" / "check-image", image, "--board", BOARD, "--tools", TOOLS,
                           *arguments, "--callgraph", *FOLDERS, *folders],
                          capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class CheckImage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refuses(self, words, *arguments, **options):
        code, output = check(*arguments, **options)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_accepts_image(self):
        code, output = check()
        self.assertEqual(code, 0, output)
        print(output.splitlines()[-1])

    def test_refuses_image_one_above_budget(self):
        report = self.folder / "report.json"
        report.write_text(json.dumps({"instructions": {"max": 1234}}))
        budgets = self.folder / "budgets.toml"
        whats = ("flash", "ram", "stack", "instructions")
        budgets.write_text(f"[{BOARD}]\n" + "".join(f"{what} = 1000000\n" for what in whats))
        _, output = check("--budgets", budgets, "--report", report)
        used = dict(re.findall(r"(\w+) (\d+) of \d+", output.splitlines()[-1]))
        self.assertEqual(set(used), set(whats))
        for tight in (None, *used):
            lines = [f"{what} = {int(amount) - (what == tight)}\n" for what, amount in used.items()]
            budgets.write_text(f"[{BOARD}]\n" + "".join(lines))
            if tight:
                self.refuses(f"{tight} is {used[tight]}, 1 over", "--budgets", budgets, "--report", report)
            else:
                code, output = check("--budgets", budgets, "--report", report)
                self.assertEqual(code, 0, output)

    def plant(self, *lines):
        (self.folder / "planted.ci").write_text("\n".join(lines) + "\n")
        return [self.folder]

    def test_refuses_unbounded_calls(self):
        tick = 'edge: { sourcename: "tactree_tick" targetname: "%s" label: "" }'
        self.refuses("calls itself", folders=self.plant(tick % "tactree_tick"))
        self.refuses("frame is unknown", folders=self.plant(tick % "printf"))
        self.refuses("calls indirectly", folders=self.plant(tick % "__indirect_call"))
        node = 'node: { title: "f" label: "f\\nf.cpp:1:1\\n8 bytes (%s)" }'
        self.refuses("its frame is dynamic", folders=self.plant(node % "dynamic", tick % "f"))

    def test_refuses_forbidden_code(self):
        source, planted = self.folder / "a.cpp", self.folder / "a.o"
        source.write_text("float f(float a, float b) { return __builtin_fmaf(a, b, a); }\n"
                          'extern "C" void* malloc(unsigned long) { return nullptr; }\n'
                          "double g(double a, double b) { return a * b; }\n")
        flags = {"arm-none-eabi-": ["-mcpu=cortex-m7", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard"],
                 "riscv64-unknown-elf-": ["-march=rv32imafc", "-mabi=ilp32f"]}[TOOLS]
        subprocess.run([TOOLS + "g++", *flags, "-O2", "-ffreestanding", "-c", source, "-o", planted],
                       check=True)
        code, output = check(image=planted)
        self.assertEqual(code, 1)
        for words in ("symbol malloc", "symbol __", "instruction "):
            self.assertIn(words, output)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
