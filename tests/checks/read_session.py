#!/usr/bin/env python3
"""Decodes messages with the layouts in the tables of docs/PROTOCOL.md.

usage: read_session.py SESSION.txt       each line "> hex" or "< hex"; prints one JSON object a frame
"""
import json
import pathlib
import re
import struct
import sys
import zlib

DOC = pathlib.Path(__file__).resolve().parents[2] / "docs/PROTOCOL.md"
FORMATS = {"u8": "B", "u16": "H", "u32": "I", "f32": "f", "char": "c"}


def read_page(text):
    """({struct: [(name, offset, type, count)]}, {kind: (request, reply)}, [(bit, bytes...)])"""
    structs, kinds, heading, enums = {}, {}, "", {}
    for line in text.splitlines():
        if line.startswith("#"):
            heading = line.strip("# ")
        cells = [cell.strip().strip("`") for cell in line.strip("|").split("|")] if line.startswith("|") else []
        named = re.match(r"`(\w+)`(, \d+ bytes)?$", heading)
        if len(cells) == 6 and cells[0].isdigit() and named:
            kind, count = re.match(r"(\w+)(?:\[(\w+)\])?", cells[2]).groups()
            structs.setdefault(named.group(1), []).append((cells[3], int(cells[0]), kind, count))
        elif len(cells) == 4 and heading == "Messages" and cells[0].startswith("0x"):
            kinds[int(cells[0], 16)] = [cell.split("`")[0].strip() for cell in cells[2:]]
        elif len(cells) == 3 and named and cells[0].isdigit():
            enums.setdefault(named.group(1), []).append((int(cells[0]), cells[1], cells[2]))
    return structs, kinds, enums


STRUCTS, KINDS, ENUMS = read_page(DOC.read_text())


def uncobs(frame):
    """The bytes of a frame without its zero."""
    out, at = bytearray(), 0
    while at < len(frame):
        code = frame[at]
        if code == 0 or at + code > len(frame):
            raise ValueError("not COBS")
        out += frame[at + 1:at + code]
        at += code
        if code < 255 and at < len(frame):
            out.append(0)
    return bytes(out)


def decode_struct(name, data):
    fields = {}
    for field, offset, kind, count in STRUCTS[name]:
        if kind not in FORMATS:
            continue
        values = struct.unpack_from(f"<{count or 1}{FORMATS[kind]}", data, offset)
        if kind == "char":
            fields[field] = b"".join(values).split(b"\0")[0].decode()
        else:
            fields[field] = list(values) if count else values[0]
    return fields


def size_of(name):
    field, offset, kind, count = STRUCTS[name][-1]
    return offset + struct.calcsize(f"<{count or 1}{FORMATS[kind]}")


def decode_telemetry(payload):
    fields = decode_struct("TelemetryHeader", payload)
    at = size_of("TelemetryHeader")
    for bit, name, meaning in ENUMS["TelemetryField"]:
        if not fields["fields"] & bit:
            continue
        types = re.findall(r"(u32|f32)(?:\[(\d)\])?", meaning) * (2 if "twice" in meaning else 1)
        values = []
        for kind, count in types:
            read = struct.unpack_from(f"<{count or 1}{FORMATS[kind]}", payload, at)
            at += 4 * len(read)
            values += read
        fields[name] = values
    if at != len(payload):
        raise ValueError("length of telemetry")
    return fields


def decode_frame(frame):
    if frame[-1:] != b"\0" or b"\0" in frame[:-1]:
        raise ValueError("a frame has one zero byte, at its end")
    raw = uncobs(frame[:-1])
    if zlib.crc32(raw[:-4]) != struct.unpack("<I", raw[-4:])[0]:
        raise ValueError("checksum")
    header = decode_struct("FrameHeader", raw)
    payload = raw[size_of("FrameHeader"):-4]
    if len(payload) != header["payload_bytes"]:
        raise ValueError("length")
    request, reply = KINDS[header["kind"] & 0x7F]
    layout = reply if header["kind"] & 0xC0 else request
    fields = {}
    if header["kind"] == 0x40:
        fields = decode_telemetry(payload)
    elif layout != "-" and header["status"] == 0:
        fields = decode_struct(layout, payload)
    return {**header, "payload": payload.hex(), "fields": fields}


def read_session(text):
    return [decode_frame(bytes.fromhex(line[2:])) for line in text.splitlines()]


if __name__ == "__main__":
    for message in read_session(pathlib.Path(sys.argv[1]).read_text()):
        print(json.dumps(message))
