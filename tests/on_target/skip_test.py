"""Promise P4: no single instruction of the gate and of the path to force, left out, gives force while
stopped. Lists the instructions of an image's functions, and lets the image do the rest in an emulator.

usage: skip_test.py IMAGE TOOLS_PREFIX [--every N]
"""
import collections
import os
import pathlib
import re
import select
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
            "none", "-no-reboot", "-semihosting-config", "enable=on,target=native", "-icount", "shift=3,sleep=off"]
SILENCE_S = 20
# The gate, the states, the supervision, the force, and the loop that carries a command to the motors.
FUNCTIONS = re.compile(
    r"tactree::core::(Controller|SafetyGate|MotorHeat|EncoderWatch|FaultMonitor|ForceStage"
    r"|PassivityController|ProbeSensor|Homing)::"
    r"|tactree::hal::Loop<.*>::(tick|listen)")
NEEDED = ("Controller::step", "Controller::execute_command", "Controller::handle_event",
          "Controller::apply_force", "FaultMonitor::update", "ForceStage::", "ProbeSensor::update",
          "EncoderWatch::update", "MotorHeat::", "SafetyGate::command", "SafetyGate::release",
          "::tick")


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


def run_emulator(folder, tried):
    """The lines ADDRESS OUTCOME up to the emulator's end, and whether that was a reset: not if the program hangs,
    nor if the processor locks up, of which the emulator prints a report instead."""
    data = struct.pack("<I", len(tried))
    data += b"".join(struct.pack("<II", address, size) for address, size, _ in tried)
    pathlib.Path(folder, "instructions").write_bytes(data)
    with subprocess.Popen([*EMULATOR, "-kernel", IMAGE], cwd=folder, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL) as emulator:
        output, ended = b"", False
        while select.select([emulator.stdout], [], [], SILENCE_S)[0]:
            part = os.read(emulator.stdout.fileno(), 65536)
            ended = not part
            if ended:
                break
            output += part
        if not ended:
            emulator.kill()
    lines = re.findall(r"^(\d+) (?:(same|other|command|force)?$|qemu: )", output.decode(errors="replace"), re.M)
    return lines, emulator.returncode == 0


def campaign(found):
    """Address -> what came of leaving out that instruction:
      same     the session went as ever
      other    the controller's state differs; no command
      command  the motors got a command but had no power: the enable line was off
      force    both
      reset    a fault, or the watchdog of the tick
      hang     or lockup: only a watchdog outside of the program helps"""
    outcomes = {}
    with tempfile.TemporaryDirectory() as folder:
        while len(outcomes) < len(found):
            tried = found[len(outcomes):]
            lines, is_reset = run_emulator(folder, tried)
            addresses = [int(address) for address, _ in lines]
            if not lines or addresses != [address for address, _, _ in tried[:len(lines)]]:
                raise AssertionError(f"not the instructions from {tried[0][0]} on: {addresses}")
            for address, outcome in lines:
                outcomes[int(address)] = outcome or ("reset" if is_reset else "hang")
    return outcomes


class Skip(unittest.TestCase):
    def test_skipped_instructions_give_no_force(self):
        found = instructions()
        functions = {f for _, _, f in found}
        for needed in NEEDED:
            self.assertTrue(any(needed in f for f in functions), needed)
        tried = found[::EVERY]
        outcomes = campaign(tried)
        sums = collections.Counter(outcomes.values())
        print(f"{len(tried)} instructions of {len(functions)} functions: {dict(sums)}")
        names = {address: f for address, _, f in found}
        forces = [f"{a:#x} {names[a]}" for a, outcome in outcomes.items() if outcome == "force"]
        self.assertEqual(forces, [])
        # Two barriers, the enable line and the command: the second one alone holds all but always.
        self.assertLess(sums["command"], len(tried) // 200)
        # What is left out makes a difference, except in functions that no stopped session calls.
        self.assertGreater(len(tried) - sums["same"], len(tried) // 20)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
