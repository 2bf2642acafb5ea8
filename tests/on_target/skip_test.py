"""Promise P4: no single instruction of the gate and of the way to force, left out, gives force while
stopped. Lists the instructions of an image's functions, and lets the image do the rest in an emulator.

usage: skip_test.py IMAGE TOOLS_PREFIX [--every N]
"""
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

EVERY = int(sys.argv.pop(sys.argv.index("--every") + 1)) if "--every" in sys.argv else 1
if "--every" in sys.argv:
    sys.argv.remove("--every")
IMAGE, TOOLS = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
EMULATOR = ["qemu-system-arm", "-M", "mps2-an386", "-display", "none", "-monitor", "none", "-serial",
            "none", "-semihosting-config", "enable=on,target=native", "-icount", "shift=3,sleep=off"]
# The gate, the states, the watches, and the loop that carries a command to the motors.
FUNCTIONS = re.compile(
    r"tactree::core::(SafetyGate|MotorHeat|EncoderWatch)::"
    r"|tactree::core::Controller::(step|watch|sense|find_joints|obey|recover|confirm|happen|raise"
    r"|apply_force|wanted_force|report|record|notice|render|forget)"
    r"|tactree::hal::Loop<.*>::(tick|listen)")


def instructions():
    """(address, bytes, function) of each, as the disassembler sees them; literals left out."""
    text = subprocess.run([f"{TOOLS}objdump", "-d", "-C", IMAGE], check=True, capture_output=True,
                          text=True).stdout
    found, function = [], ""
    for line in text.splitlines():
        head = re.match(r"[0-9a-f]+ <(.*)>:$", line)
        if head:
            function = head[1]
            continue
        code = re.match(r"\s*([0-9a-f]+):\t([0-9a-f]{4})( [0-9a-f]{4})? *\t(\S+)", line)
        if code and FUNCTIONS.match(function) and not code[4].startswith("."):
            found.append((int(code[1], 16), 4 if code[3] else 2, function))
    return found


class Skip(unittest.TestCase):
    def test_no_instruction_left_out_gives_force_while_stopped(self):
        found = instructions()
        functions = {f for _, _, f in found}
        for needed in ("Controller::step", "SafetyGate::command", "SafetyGate::release", "::tick"):
            self.assertTrue(any(needed in f for f in functions), needed)
        tried = found[::EVERY]
        with tempfile.TemporaryDirectory() as folder:
            data = struct.pack("<I", len(tried))
            data += b"".join(struct.pack("<II", address, size) for address, size, _ in tried)
            pathlib.Path(folder, "instructions").write_bytes(data)
            done = subprocess.run([*EMULATOR, "-kernel", IMAGE], cwd=folder, capture_output=True,
                                  text=True, timeout=1500, check=False)
        output = done.stdout + done.stderr
        names = {address: f for address, _, f in found}
        forces = [int(a) for a in re.findall(r"^force (\d+)$", output, re.M)]
        self.assertEqual([f"{a:#x} {names[a]}" for a in forces], [])
        self.assertEqual(done.returncode, 0, output)
        figures = {k: int(v) for k, v in re.findall(r"^(tried|resets|noticed) (\d+)$", output, re.M)}
        self.assertEqual(figures["tried"], len(tried), output)
        # What is left out does make a difference.
        self.assertGreater(figures["noticed"] + figures["resets"], len(tried) // 10, output)
        print(f"{len(tried)} instructions of {len(functions)} functions; {figures['resets']} ended in a "
              f"reset, {figures['noticed']} in another state, none in a force")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
