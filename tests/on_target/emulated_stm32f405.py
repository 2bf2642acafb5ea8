"""The chip of the board stm32f405 in an emulator, and a client at its serial port that speaks what
docs/PROTOCOL.md says.
"""
import os
import pathlib
import select
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "checks"))
import read_session  # from docs/PROTOCOL.md

EMULATOR = ["qemu-system-arm", "-M", "netduinoplus2", "-display", "none", "-monitor", "none",
            "-icount", "shift=3,sleep=off"]
BLOB_ADDRESS = 0x08020000
# The emulator begins with a flash of zeros, which the store's records are not.
RECORDS_ADDRESS, RECORDS = 0x08004000, bytes(b"\xff" * 32768)
IDENTIFY, OPEN, READ_START = 0x01, 0x02, 0x22


def cobs(data):
    """A frame of docs/PROTOCOL.md, with the zero at the end."""
    out, begin = bytearray(), 0
    while begin <= len(data):
        end = data.find(0, begin, begin + 254)
        if end < 0:
            end = min(begin + 254, len(data))
        out += bytes([end - begin + 1]) + data[begin:end]
        begin = end + (0 if end - begin == 254 else 1)
    return bytes(out) + b"\0"


def boot_command(folder, load, blob, serial):
    """`load`: arguments that give the program; `blob`: where the model of the image is."""
    command = [*EMULATOR, "-serial", serial, *load]
    for name, content, address in (("records", RECORDS, RECORDS_ADDRESS), ("blob", blob, BLOB_ADDRESS)):
        if content:
            file = pathlib.Path(folder, name)
            file.write_bytes(content)
            command += ["-device", f"loader,file={file},addr={address:#x},force-raw=on"]
    return command


class Emulator:
    """An image that boots, and a client at its serial port."""

    def __init__(self, load, blob=b""):
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(boot_command(self.folder.name, load, blob, "stdio"),
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.sequence = self.session = 0
        while not self.hears():
            pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()
        self.folder.cleanup()

    def send(self, kind, payload=b""):
        self.sequence += 1
        raw = struct.pack("<BBHHH", kind, 0, self.sequence, self.session, len(payload)) + payload
        self.process.stdin.write(cobs(raw + struct.pack("<I", zlib.crc32(raw))))
        self.process.stdin.flush()

    def hears(self):
        """What comes before its port is ready is lost."""
        self.send(IDENTIFY)
        return bool(select.select([self.process.stdout], [], [], 0.2)[0])

    def ask(self, kind, payload=b""):
        """The reply's header and fields."""
        self.send(kind, payload)
        reply = {"sequence": None}
        while reply["sequence"] != self.sequence:  # replies to former ones, of when it began to hear
            frame = bytearray()
            while frame[-1:] != b"\0":
                frame += os.read(self.process.stdout.fileno(), 1)
            reply = read_session.decode_frame(bytes(frame))
        assert reply["kind"] == kind | 0x80, reply
        return reply

    def open(self):
        self.session = self.ask(OPEN, struct.pack("<BBHI", 1, 0, 0, 7))["fields"]["session"]

    def start(self):
        return self.ask(READ_START)["fields"]
