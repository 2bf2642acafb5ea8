"""`tactree image`: every format, read by independent decoders, and every refusal.

usage: image_command_test.py TACTREE BLOB BUILD_FOLDER
BUILD_FOLDER holds the builds of the firmware; what needs them is skipped without.
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
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "on_target"))
from emulated_stm32f405 import Emulator

TACTREE, BLOB = sys.argv[1:3]
BUILD = pathlib.Path(sys.argv[3])
CODE, CODE_END, PLACE, PLACE_END = 0x08000000, 0x08020000, 0x08020000, 0x08100000
FAMILY = 0x57755A57
GOOD_BLOB = pathlib.Path(BLOB).read_bytes()


# ---- decoders: address -> byte

def from_hex(data):
    memory, upper, ended = {}, 0, False
    for line in data.decode("ascii").splitlines():
        assert not ended and line[0] == ":", line
        record = bytes.fromhex(line[1:])
        size, address, kind, body = record[0], int.from_bytes(record[1:3], "big"), record[3], record[4:-1]
        assert size == len(body) and sum(record) % 256 == 0, line
        if kind == 0:
            assert address + size <= 0x10000
            for i, byte in enumerate(body):
                assert (upper << 16) + address + i not in memory
                memory[(upper << 16) + address + i] = byte
        elif kind == 4:
            upper = int.from_bytes(body, "big")
        else:
            assert kind in (1, 5), line
            ended = kind == 1
    assert ended
    return memory


def from_uf2(data, family):
    memory = {}
    assert len(data) % 512 == 0
    for number in range(len(data) // 512):
        block = data[512 * number:512 * (number + 1)]
        first, second, flags, address, size, at, count, kind = struct.unpack("<8I", block[:32])
        assert (first, second, block[-4:]) == (0x0A324655, 0x9E5D5157, struct.pack("<I", 0x0AB16F30))
        assert (at, count, size, address % 256) == (number, len(data) // 512, 256, 0)
        assert (flags, kind) == ((0x2000, family) if family else (0, 0))
        for i in range(size):
            memory[address + i] = block[32 + i]
    return memory


def from_bin(data, address=CODE):
    return {address + i: byte for i, byte in enumerate(data)}


def from_dfu(data, usb=(0xFFFF, 0xFFFF)):
    device, product, vendor, version, mark, length, checksum = struct.unpack("<4H3sBI", data[-16:])
    assert (vendor, product) == usb and (device, version, mark, length) == (0xFFFF, 0x100, b"UFD", 16)
    assert checksum == zlib.crc32(data[:-4]) ^ 0xFFFFFFFF
    return from_bin(data[:-16])


def from_elf(data, sections=False):
    """By program headers, or by the sections that are loaded."""
    memory = {}
    (phoff, shoff, _, _, phsize, phnum, shsize, shnum, names) = struct.unpack("<3I6H", data[28:52])
    if sections:
        headers = [struct.unpack("<10I", data[shoff + i * shsize:][:40]) for i in range(shnum)]
        text = headers[names][4]
        for name, kind, flags, address, offset, size, *_ in headers:
            if kind == 1 and flags & 2:
                name = data[text + name:data.index(b"\0", text + name)]
                memory[name.decode()] = from_bin(data[offset:offset + size], address)
        return memory
    for i in range(phnum):
        kind, offset, _, address, size, *_ = struct.unpack("<8I", data[phoff + i * phsize:][:32])
        if kind == 1:
            memory.update(from_bin(data[offset:offset + size], address))
    return memory


# ---- a firmware image as small as one can be

def identity(mark=b"TACTIMG", board=b"stm32f405", place=(PLACE, PLACE_END)):
    """But for the checksum at its end."""
    return struct.pack("<8s24s5I", mark, board, CODE, CODE_END, *place, FAMILY)


def firmware(code=None, address=CODE, machine=40, **identities):
    code = bytes(range(256)) * 5 + b"xyz" if code is None else code
    code += bytes(-len(code) % 4) + identity(**identities)
    program = code + struct.pack("<I", zlib.crc32(b"vars", zlib.crc32(code))) + b"vars"
    header = struct.pack("<4s5B7x2H5I6H", b"\x7fELF", 1, 1, 1, 0, 0, 2, machine, 1, address | 1, 52, 0, 0,
                         52, 32, 3, 40, 0, 0)
    size = len(program) - 4
    table = struct.pack("<8I", 1, 148, address, address, size, size, 5, 4)
    table += struct.pack("<8I", 1, 148 + size, 0x20000000, address + size, 4, 4, 6, 4)  # .data
    table += struct.pack("<8I", 1, 0, 0x20000000, 0x20000000, 0, 64, 6, 4)  # .bss: nothing to load
    return header + table + program


# ---- a firmware outside the tree: with a record in the middle of its code, and initial values

SEAL = pathlib.Path(__file__).resolve().parents[2] / "scripts/seal-image"


def own_firmware(record=True, place=(PLACE, 0x80000), family=FAMILY, data=CODE + 0x10000):
    code = bytes(range(256)) * 2
    if record:
        code += struct.pack("<8s24s4I60x", b"TACTOWN", b"hc3", 168000000, *place, family)
    code += bytes(range(255, -1, -1))
    program = code + b"vars"
    header = struct.pack("<4s5B7x2H5I6H", b"\x7fELF", 1, 1, 1, 0, 0, 2, 40, 1, CODE | 1, 52, 0, 0, 52, 32, 2, 40, 0, 0)
    table = struct.pack("<8I", 1, 116, CODE, CODE, len(code), len(code), 5, 4)
    table += struct.pack("<8I", 1, 116 + len(code), 0x20000000, data, 4, 4, 6, 4)
    return header + table + program


class Image(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, data):
        (self.folder / name).write_bytes(data)
        return self.folder / name

    def run_image(self, *arguments):
        return subprocess.run([TACTREE, "image", *map(str, arguments)], capture_output=True, text=True,
                              check=False)

    def make(self, ending, *arguments, elf=None, blob=GOOD_BLOB):
        output = self.folder / f"out.{ending}"
        blobs = [self.file("model.blob", blob)] if blob else []
        done = self.run_image(self.file("firmware.elf", elf or firmware()), *blobs, "-o", output, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return output.read_bytes()

    def refused(self, *words, elf=None, blob=GOOD_BLOB, arguments=(), ending="hex", code=1):
        output = self.folder / f"refused.{ending}"
        done = self.run_image(self.file("firmware.elf", firmware() if elf is None else elf),
                              self.file("model.blob", blob), "-o", output, *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertFalse(output.exists())
        for word in words:
            self.assertIn(word, done.stderr)

    def expected(self, elf=None):
        memory = from_elf(elf or firmware())
        memory.update(from_bin(GOOD_BLOB, PLACE))
        return memory

    def equal_but_for_erased(self, found, expected):
        for address, byte in found.items():
            self.assertEqual(byte, expected.get(address, 0xFF), hex(address))
        self.assertLessEqual(set(expected), set(found))

    # ---- each format holds every byte at its address, and no other

    def test_writes_hex(self):
        self.assertEqual(from_hex(self.make("hex")), self.expected())

    def test_writes_uf2(self):
        self.equal_but_for_erased(from_uf2(self.make("uf2"), FAMILY), self.expected())

    def test_writes_bin(self):
        self.equal_but_for_erased(from_bin(self.make("bin")), self.expected())
        self.assertEqual(len(self.make("bin")), PLACE - CODE + len(GOOD_BLOB))

    def test_writes_dfu(self):
        self.equal_but_for_erased(from_dfu(self.make("dfu")), self.expected())
        from_dfu(self.make("dfu", "--usb", "0483:df11"), (0x0483, 0xDF11))

    def test_writes_elf(self):
        self.assertEqual(from_elf(self.make("elf")), self.expected())

    def test_writes_firmware_without_blob(self):
        self.assertEqual(self.make("elf", blob=None), firmware())
        self.assertEqual(from_hex(self.make("hex", blob=None)), from_elf(firmware()))

    def test_writes_code_of_every_length(self):
        for size in range(0, 40):
            elf = firmware(bytes(range(size)))
            self.assertEqual(from_hex(self.make("hex", elf=elf)), self.expected(elf))

    def test_writes_unaligned_code_across_64_kib(self):
        elf = firmware(bytes(range(256)) * 300, address=CODE + 4)
        self.assertEqual(from_hex(self.make("hex", elf=elf)), self.expected(elf))

    def test_selects_format_by_option(self):
        data = self.make("image", "--format", "uf2", "--json", self.folder / "r.json", "--board", "stm32f405")
        from_uf2(data, FAMILY)
        report = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(report["board"], "stm32f405")
        self.assertEqual(report["blob_bytes"], len(GOOD_BLOB))
        self.assertEqual(report["file_bytes"], len(data))

    # ---- refused before there is a file to flash

    def test_refuses_image_of_other_board(self):
        self.refused("wrong board", "for stm32f405, not for mps2-an500", arguments=("--board", "mps2-an500"))

    def test_refuses_too_large_blob(self):
        room = len(GOOD_BLOB) - 1
        small = firmware(place=(PLACE, PLACE + room))
        self.refused("too large for stm32f405", f"--flash-budget {room}", elf=small)
        self.make("hex", elf=firmware(place=(PLACE, PLACE + len(GOOD_BLOB))))

    def test_refuses_truncated_or_corrupt_blob(self):
        self.refused("refused", "shorter than a blob's header", blob=GOOD_BLOB[:16])
        self.refused("refused", blob=GOOD_BLOB[:-1])
        self.refused("refused", blob=GOOD_BLOB + b"\0")
        self.refused("refused", "checksum", blob=GOOD_BLOB[:-5] + bytes([GOOD_BLOB[-5] ^ 1]) + GOOD_BLOB[-4:])
        self.refused("refused", "tactree build", blob=b"ply\nformat ascii 1.0\n" * 100)

    def test_refuses_image_truncated_anywhere(self):
        whole = firmware()
        for size in [*range(0, 130), len(whole) // 2, len(whole) - 1]:
            self.refused("firmware.elf", "truncated", elf=whole[:size])

    def test_refuses_image_with_flipped_bit(self):
        whole = firmware()
        for at in range(148, len(whole), 7):
            wrong = bytearray(whole)
            wrong[at] ^= 1 << at % 8
            self.refused("firmware.elf", elf=wrong)
        wrong = bytearray(whole)
        wrong[200] ^= 1
        self.refused("damaged: its checksum does not match", elf=wrong)

    def test_refuses_other_files(self):
        self.refused("not an ELF file", elf=b"\x7fELG" + firmware()[4:])
        self.refused("not a program for", elf=firmware(machine=62))
        self.refused("it does not name its board", elf=firmware(mark=b"TACTICS"))
        self.refused("several identification records", elf=firmware(identity() + bytes(4)))
        self.refused("malformed board name", elf=firmware(board=b"b" * 24))
        self.refused("address ranges of code and blob are invalid", elf=firmware(place=(PLACE_END, PLACE)))
        self.refused("outside the board's code", elf=firmware(address=CODE - 4))
        self.refused("outside the board's code", elf=firmware(bytes(0x20000)))

    def test_refuses_gap_in_flat_file(self):
        far = firmware(place=(0x60000000, 0x61000000))
        for ending in ("bin", "dfu"):
            self.refused("use .elf, .hex or .uf2", elf=far, ending=ending)
        self.make("hex", elf=far)

    def test_refuses_bad_usage(self):
        self.refused("cannot infer the format from the extension", ending="img", code=2)
        self.refused("--usb", arguments=("--usb", "0483df11"), code=2)
        self.refused("--usb", arguments=("--usb", "04:3:df11"), code=2)

    # ---- a firmware outside the tree

    def sealed(self, **facts):
        elf = self.file("own.elf", own_firmware(**facts))
        subprocess.run([sys.executable, SEAL, elf], check=True)
        return elf.read_bytes()

    def test_own_firmware_with_a_record_states_its_room(self):
        elf = self.sealed()
        self.assertEqual(from_hex(self.make("hex", elf=elf)), self.expected(elf))
        self.make("hex", "--board", "hc3", elf=elf)
        from_uf2(self.make("uf2", elf=elf), FAMILY)
        self.refused("for hc3, not for stm32f405", elf=elf, arguments=("--board", "stm32f405"))
        self.refused("states the room of its blob itself", elf=elf,
                     arguments=("--blob-at", "0x08020000", "--room", "896K"))
        self.refused("too large for hc3", elf=self.sealed(place=(PLACE, 64)))
        self.refused("states no room", "`tactree image` by --blob-at", elf=self.sealed(place=(0, 0)))

    def test_own_firmware_must_be_sealed_after_its_last_change(self):
        self.refused("is not sealed", "seal-image", elf=own_firmware())
        whole = self.sealed()
        for at in range(116, len(whole), 5):
            wrong = bytearray(whole)
            wrong[at] ^= 1 << at % 8
            self.refused("firmware.elf", elf=wrong)

    def test_own_firmware_without_a_record_needs_a_place(self):
        elf = own_firmware(record=False)
        place = ("--blob-at", hex(PLACE), "--room", "896K")
        self.assertEqual(from_hex(self.make("hex", *place, elf=elf)), self.expected(elf))
        self.refused("does not name its board", "--blob-at", elf=elf)
        self.refused("--room", elf=elf, arguments=place[:2], code=2)
        self.refused("--blob-at", elf=elf, arguments=place[2:], code=2)
        self.refused("is not a number", elf=elf, arguments=("--blob-at", "here", "--room", "1K"))
        for at, room in ((PLACE + 1, "1K"), (PLACE, "0"), (0xFFFFFFFC, "8")):
            self.refused("are no room for a blob", elf=elf, arguments=("--blob-at", hex(at), "--room", room))
        for at, room in ((CODE - 16, "20"), (CODE + 0x10000, "1M"), (CODE, "1M")):
            self.refused("lie in the room of the blob", elf=elf, arguments=("--blob-at", hex(at), "--room", room))
        self.refused("segments overlap", elf=own_firmware(record=False, data=CODE + 8), arguments=place)

    def test_uf2_of_an_own_firmware_needs_the_family_of_the_chip(self):
        elf = own_firmware(record=False)
        place = ("--blob-at", hex(PLACE), "--room", "896K")
        self.refused("UF2 family", "--uf2-family", elf=elf, arguments=place, ending="uf2")
        from_uf2(self.make("uf2", *place, "--uf2-family", "0xE48BFF59", elf=elf), 0xE48BFF59)
        self.refused("UF2 family", elf=self.sealed(family=0), ending="uf2")

    def test_a_file_describes_the_board(self):
        board = {"name": "hc3", "blob": {"at": hex(PLACE), "room": "896K"}, "uf2_family": hex(FAMILY)}
        file = self.file("hc3.json", json.dumps(board).encode())
        elf = own_firmware(record=False)
        from_uf2(self.make("uf2", "--board", file, elf=elf), FAMILY)
        report = self.folder / "r.json"
        self.make("hex", "--board", file, "--json", report, elf=elf)
        self.assertEqual(json.loads(report.read_text())["board"], "hc3")
        self.make("hex", "--board", file, elf=self.sealed())
        self.refused("for stm32f405, not for hc3", arguments=("--board", file))
        for key, value, cause in (("name", "", "characters"), ("blob", {"at": "0"}, "blob.room: is missing"),
                                  ("blob", {"at": "8 MB", "room": "1"}, "is not a number"),
                                  ("toaster", 1, "is unknown")):
            self.file("hc3.json", json.dumps({**board, key: value}).encode())
            self.refused("hc3.json", cause, elf=elf, arguments=("--board", file))
        self.file("hc3.json", b"{")
        self.refused("not valid JSON", elf=elf, arguments=("--board", file))

    def test_a_model_is_built_for_the_room_in_the_file_of_the_board(self):
        elf = self.file("own.elf", own_firmware(record=False))
        scan = self.file("plane.xyz", "".join(f"{x} {y} 0\n" for x in range(60) for y in range(60)).encode())
        model = self.folder / "plane.blob"

        def build(*arguments):
            return subprocess.run([TACTREE, "build", scan, "--unit", "mm", "--for", elf, "-o", model, "--progress",
                                   "off", *arguments], capture_output=True, text=True, check=False)

        refused = build()
        self.assertEqual(refused.returncode, 1)
        self.assertIn("--board FILE.json", refused.stderr)
        self.assertEqual(build("--blob-at", hex(PLACE), "--room", "64K").returncode, 2)
        sizes = []
        for room in (8 << 10, 20 << 10):
            board = {"name": "hc3", "blob": {"at": hex(PLACE), "room": f"{room >> 10}K"}}
            done = build("--board", self.file("hc3.json", json.dumps(board).encode()))
            self.assertEqual(done.returncode, 0, done.stderr)
            sizes.append(model.stat().st_size)
            self.assertLessEqual(sizes[-1], room)
        self.assertGreater(sizes[1], sizes[0])
        self.make("hex", "--board", self.folder / "hc3.json", elf=elf.read_bytes(), blob=model.read_bytes())

    # ---- the boards' own images

    def real(self, core, board):
        folder = BUILD / core / "firmware"
        # Without the crystal that the emulator lacks, no model would be in time.
        for image in (folder / "bare" / f"{board}.elf", folder / f"{board}.elf"):
            if image.exists():
                return image.read_bytes()
        return self.skipTest(f"{image} is not built")

    def test_merges_image_for_every_board(self):
        boards = sorted(BUILD.glob("*/firmware/*.elf"))
        if not boards:
            self.skipTest("no firmware is built")
        for image in boards:
            elf = image.read_bytes()
            at = elf.index(b"TACTIMG\0")
            board, _, _, place, _, family, _ = struct.unpack("<8x24s6I", elf[at:at + 56])
            self.assertEqual(board.rstrip(b"\0").decode(), image.stem)
            expected = from_elf(elf)
            expected.update(from_bin(GOOD_BLOB, place))
            self.assertEqual(from_hex(self.make("hex", elf=elf)), expected)
            self.equal_but_for_erased(from_uf2(self.make("uf2", elf=elf), family), expected)
            merged = self.make("elf", elf=elf)
            self.assertEqual(from_elf(merged), expected)
            sections = from_elf(merged, sections=True)
            self.assertEqual(sections.pop(".blob"), from_bin(GOOD_BLOB, place))
            self.assertEqual(sections, from_elf(elf, sections=True))

    def test_merged_image_boots_with_model(self):
        elf = self.real("cortex-m4f", "stm32f405")
        for ending in ("elf", "hex"):
            self.make(ending, elf=elf)
            file = self.folder / f"out.{ending}"
            with Emulator(["-kernel", file] if ending == "elf" else ["-device", f"loader,file={file}"]) as board:
                start = board.start()
            self.assertEqual([start[name] for name in ("configuration", "blob", "model", "image")], [0, 0, 0, 0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
