"""The image of stm32f405 in an emulator that has the chip's core, timers and serial port, but no clocks,
pins, DMA or watchdog: it must get through its start, tell an application at its serial port what is
missing, judge the blob, and give no force.

usage: stm32f405_test.py IMAGE CONFORMANCE_IMAGE BLOB TACTREE
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

sys.dont_write_bytecode = True
from emulated_stm32f405 import EMULATOR, Emulator, boot_command

IMAGE, CONFORMANCE, BLOB, TACTREE = sys.argv[1:5]
# The image before the costs of a tick were embedded; or the image itself, if it has none.
BARE = pathlib.Path(IMAGE).parent / "bare" / pathlib.Path(IMAGE).name
STATE, CONTROL, BEGIN_MODEL = 0x06, 0x07, 0x11
ARM = bytes([1]) + bytes(7)
NOT_NOW, STORAGE_FAILED = 7, 23
MOTORS, ENABLE_LINE, SAFETY_INPUTS, WATCHDOG, RECEIVER, CRYSTAL = 2, 4, 8, 16, 32, 256
BLOB_OK, MODEL_OK, MODEL_TOO_SLOW = 0, 0, 11
IMAGE_OK, IMAGE_DAMAGED = 0, 1
VECTOR_OF_NO_EXCEPTION = 4 * 8


class Stm32f405(unittest.TestCase):
    def no_force(self, board):
        """It ticks, refuses to be armed, and gives no force. Its faults."""
        board.open()
        self.assertEqual(board.ask(CONTROL, ARM)["status"], NOT_NOW)
        ticks = []
        for _ in range(20):
            state = board.ask(STATE)["fields"]
            ticks.append(state["tick"])
            self.assertEqual(state["force_N"], [0, 0, 0])
        self.assertEqual(ticks, sorted(set(ticks)))
        return state["faults"]

    def test_reports_missing_parts(self):
        with Emulator(["-kernel", IMAGE], pathlib.Path(BLOB).read_bytes()) as board:
            start = board.start()
            self.assertEqual(start["missing"],
                             CRYSTAL | MOTORS | ENABLE_LINE | SAFETY_INPUTS | WATCHDOG | RECEIVER)
            # Without a crystal the core runs at 16 MHz, where no model is in time.
            model = MODEL_TOO_SLOW if BARE.exists() else MODEL_OK
            self.assertEqual([start[name] for name in ("configuration", "blob", "model", "image")],
                             [0, BLOB_OK, model, IMAGE_OK])
            self.assertEqual(start["fault_cause"], 0)
            self.assertEqual(self.no_force(board), 1 << 1 | 1 << 9)  # emergency stop, motors

    def test_erases_nothing_without_extended_watchdog(self):
        blob = pathlib.Path(BLOB).read_bytes()
        with Emulator(["-kernel", IMAGE], blob) as board:
            board.open()
            begin = struct.pack("<24sIII", b"", 0, len(blob), zlib.crc32(blob))
            self.assertEqual(board.ask(BEGIN_MODEL, begin)["status"], STORAGE_FAILED)

    @unittest.skipUnless(BARE.exists(), "the image does not know what a tick costs")
    def test_accepts_model_without_embedded_costs(self):
        with Emulator(["-kernel", BARE], pathlib.Path(BLOB).read_bytes()) as board:
            start = board.start()
            self.assertEqual([start["blob"], start["model"], start["image"]], [BLOB_OK, MODEL_OK, IMAGE_OK])
            self.no_force(board)

    def test_reports_invalid_blob(self):
        good = pathlib.Path(BLOB).read_bytes()
        flipped = bytearray(good)
        flipped[-5] ^= 4
        too_large = bytearray(good)
        total = good.index(struct.pack("<I", len(good)))
        too_large[total:total + 4] = struct.pack("<I", 896 * 1024 + 4)
        refusals = set()
        for blob in (b"", b"\xff" * 4096, good[:len(good) // 2], bytes(flipped), bytes(too_large)):
            with Emulator(["-kernel", IMAGE], blob) as board:
                told = board.start()["blob"]
                self.assertNotEqual(told, BLOB_OK)
                refusals.add(told)
                self.no_force(board)
        self.assertEqual(len(refusals), 4)  # too short, magic, checksum, size

    def test_reports_damaged_image(self):
        image = pathlib.Path(IMAGE).read_bytes()
        (table,) = struct.unpack_from("<I", image, 28)
        (vectors,) = struct.unpack_from("<I", image, table + 4)
        self.assertEqual(struct.unpack_from("<I", image, table + 12)[0], 0x08000000)
        # Unused places: after the board's name, and in a handler that is never called.
        for place in (image.index(b"TACTIMG\0") + 30, vectors + VECTOR_OF_NO_EXCEPTION):
            data = bytearray(image)
            data[place] ^= 1
            with tempfile.TemporaryDirectory() as folder:
                damaged = pathlib.Path(folder, "damaged.elf")
                damaged.write_bytes(data)
                with Emulator(["-kernel", damaged], pathlib.Path(BLOB).read_bytes()) as board:
                    self.assertEqual(board.start()["image"], IMAGE_DAMAGED)
                    self.no_force(board)

    @unittest.skipUnless(pathlib.Path(TACTREE).exists(), "there is no tactree (build the preset host-gcc)")
    def test_command_line_session(self):
        with tempfile.TemporaryDirectory() as folder, subprocess.Popen(
                boot_command(folder, ["-kernel", IMAGE], pathlib.Path(BLOB).read_bytes(),
                             f"unix:{folder}/port,server=on,wait=off"), stdin=subprocess.DEVNULL) as emulator:
            port = f"unix:{folder}/port"

            def call(*arguments):
                return subprocess.run([TACTREE, *map(str, arguments), "--port", port], capture_output=True,
                                      text=True, check=False)

            def run(*arguments, code=0):
                done = call(*arguments)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                return done.stdout + done.stderr

            try:
                while call("devices").returncode != 0:
                    pass  # it boots
                told = run("devices")
                self.assertIn("stm32f405, firmware", told)
                self.assertIn("motors disabled; did not start: motors, enable line", told)
                self.assertIn("crystal", told)
                result = pathlib.Path(folder, "seen.json")
                run("monitor", "--once", "--json", result, code=1)  # it has faults
                self.assertIn("motor-fault", json.loads(result.read_text())["fault_names"])
                self.assertIn("delay_s", run("params"))
                self.assertIn("empty", run("flash", "--list"))
                self.assertIn("the fault emergency-stop", run("arm", code=1))
                self.assertIn("tick,state,contact", run("trace"))
                self.assertIn("stopped", run("stop"))
                self.assertIn("writing the flash failed", run("flash", BLOB, code=1))
            finally:
                emulator.kill()

    def test_conformance_program_reports_missing_parts(self):
        done = subprocess.run([*EMULATOR, "-semihosting-config", "enable=on,target=native", "-serial",
                               "null", "-kernel", CONFORMANCE], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        found = (done.stdout + done.stderr).splitlines()
        self.assertEqual(found, [
            "an encoder at rest changes its count",  # the emulated timers have no encoder mode
            "the motor bank fails on commands of zero",
            "the read-back does not follow when the enable line goes on",
            "the emergency stop reads as pressed",
            "conformance failed",
        ])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
