"""The image of stm32f405 in an emulator that has the chip's core, timers and serial port, but no clocks,
pins, DMA or watchdog: it must get through its start, tell over its serial port what is missing, judge the
blob, and give no force.

usage: stm32f405_test.py IMAGE CONFORMANCE_IMAGE BLOB
"""
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

IMAGE, CONFORMANCE, BLOB = sys.argv[1:4]
# As it was before it was told what a tick costs; else it still is so.
BARE = pathlib.Path(IMAGE).parent / "bare" / pathlib.Path(IMAGE).name
EMULATOR = ["qemu-system-arm", "-M", "netduinoplus2", "-display", "none", "-monitor", "none",
            "-icount", "shift=3,sleep=off"]
BLOB_ADDRESS = 0x08020000

# firmware/stm32f4/frames.hpp, decoded by hand.
BOOT_BYTES, STATUS_BYTES = 92, 44
CRYSTAL = 1
ENCODERS, MOTORS, ENABLE_LINE, SAFETY_INPUTS, WATCHDOG = 1, 2, 4, 8, 16
STATES = ["boot", "no-model", "idle", "armed", "active", "fault"]
BLOB_OK = 0
MODEL_OK, MODEL_TOO_SLOW = 0, 11
IMAGE_OK, IMAGE_DAMAGED = 0, 1
STATUS_FRAMES = 20


def frames_of(data):
    """The frames of a stream of bytes, each with its checksum checked."""
    frames = []
    while data:
        assert data[:1] == b"T", data[:8]
        size = {b"b": BOOT_BYTES, b"s": STATUS_BYTES}[data[1:2]]
        frame, data = data[:size], data[size:]
        assert struct.unpack("<I", frame[-4:])[0] == zlib.crc32(frame[:-4]), frame.hex()
        frames.append(frame)
    return frames


class Stm32f405(unittest.TestCase):
    def boot(self, blob, image=IMAGE):
        """Boot frame and status frames of a run with these bytes where the blob should be."""
        with tempfile.TemporaryDirectory() as folder:
            command = [*EMULATOR, "-serial", "stdio", "-kernel", image]
            if blob:
                file = pathlib.Path(folder, "blob")
                file.write_bytes(blob)
                command += ["-device", f"loader,file={file},addr={BLOB_ADDRESS:#x},force-raw=on"]
            with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE) as emulator:
                data = emulator.stdout.read(BOOT_BYTES + STATUS_FRAMES * STATUS_BYTES)
                emulator.kill()
        boot, *statuses = frames_of(data)
        self.assertEqual(boot[1:2], b"b")
        self.assertEqual(len(statuses), STATUS_FRAMES)
        return boot, statuses

    def no_force(self, statuses):
        ticks = []
        for frame in statuses:
            state, tick = frame[3], struct.unpack("<I", frame[4:8])[0]
            ticks.append(tick)
            self.assertNotIn(STATES[state], ("armed", "active"))
            self.assertEqual(frame[28:40], bytes(12), "a force")
        self.assertEqual(ticks, sorted(set(ticks)))

    def test_what_is_missing_is_told(self):
        boot, statuses = self.boot(pathlib.Path(BLOB).read_bytes())
        self.assertEqual(boot[3], CRYSTAL)
        self.assertEqual(boot[4], MOTORS | ENABLE_LINE | SAFETY_INPUTS | WATCHDOG)
        # Without a crystal the core runs at 16 MHz, where no model is in time.
        model = MODEL_TOO_SLOW if BARE.exists() else MODEL_OK
        self.assertEqual(boot[6:10], bytes([0, BLOB_OK, model, IMAGE_OK]))
        self.no_force(statuses)
        faults = struct.unpack("<I", statuses[-1][8:12])[0]
        self.assertEqual(faults, 1 << 1 | 1 << 9)  # emergency stop, motors

    @unittest.skipUnless(BARE.exists(), "the image does not know what a tick costs")
    def test_without_its_costs_a_board_takes_the_model(self):
        boot, statuses = self.boot(pathlib.Path(BLOB).read_bytes(), BARE)
        self.assertEqual(boot[6:10], bytes([0, BLOB_OK, MODEL_OK, IMAGE_OK]))
        self.no_force(statuses)

    def test_a_wrong_blob_is_told(self):
        good = pathlib.Path(BLOB).read_bytes()
        flipped = bytearray(good)
        flipped[-5] ^= 4
        too_large = bytearray(good)
        total = good.index(struct.pack("<I", len(good)))
        too_large[total:total + 4] = struct.pack("<I", 896 * 1024 + 4)
        refusals = set()
        for blob in (b"", b"\xff" * 4096, good[:len(good) // 2], bytes(flipped), bytes(too_large)):
            boot, statuses = self.boot(blob)
            self.assertNotEqual(boot[7], BLOB_OK)
            refusals.add(boot[7])
            self.no_force(statuses)
        self.assertEqual(len(refusals), 4)  # too short, magic, checksum, size

    def test_a_damaged_image_is_told(self):
        data = bytearray(pathlib.Path(IMAGE).read_bytes())
        data[data.index(b"TACTIMG\0") + 30] ^= 1  # behind the board's name: in no one's way
        with tempfile.TemporaryDirectory() as folder:
            damaged = pathlib.Path(folder, "damaged.elf")
            damaged.write_bytes(data)
            boot, statuses = self.boot(pathlib.Path(BLOB).read_bytes(), damaged)
        self.assertEqual(boot[9], IMAGE_DAMAGED)
        self.no_force(statuses)

    def test_the_conformance_program_finds_the_missing_parts(self):
        done = subprocess.run([*EMULATOR, "-semihosting-config", "enable=on,target=native", "-serial",
                               "null", "-kernel", CONFORMANCE], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False, timeout=100)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        found = (done.stdout + done.stderr).splitlines()
        self.assertEqual(found, [
            "an encoder at rest counts",  # the emulated timers know no encoder mode
            "the motor bank fails on commands of zero",
            "the read-back does not follow when the enable line goes on",
            "the emergency stop reads as pressed",
            "conformance failed",
        ])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
