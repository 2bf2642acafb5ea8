#!/usr/bin/env python3
"""A reader made from docs/PROTOCOL.md decodes a session as the library does.

usage: session_reader_test.py RECORD_SESSION GOLDEN.txt
"""
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import read_session  # noqa: E402

FIELD_OF_TELEMETRY = {"force_N[0]": ("kForce", 0), "probe_m[0]": ("kProbe", 0)}


def value_of(message, name):
    if message["kind"] == 0x40 and name in FIELD_OF_TELEMETRY:
        field, index = FIELD_OF_TELEMETRY[name]
        return message["fields"][field][index]
    field, index = re.match(r"(\w+)(?:\[(\d)\])?", name).groups()
    value = message["fields"][field]
    return value[int(index)] if index else value


def compare(messages, content):
    fields = 0
    assert len(messages) == len(content) > 60, (len(messages), len(content))
    for message, line in zip(messages, content):
        head, rest = line.split(".", 1)
        kind, status, sequence, session, *payload = head.split(" ")
        ours = [int(kind), int(status), int(sequence), int(session), "".join(payload)]
        theirs = [message[key] for key in ("kind", "status", "sequence", "session", "payload")]
        assert ours == theirs, (ours, theirs)
        for name, value in re.findall(r"([\w\[\]]+)=(\S+)", rest):
            read = value_of(message, name)
            assert abs(float(value) - read) <= 1e-7 * max(1.0, abs(read)), (name, value, read)
            fields += 1
    assert fields > 60, fields


def main():
    recorder, golden = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        session, content = pathlib.Path(folder, "session"), pathlib.Path(folder, "content")
        subprocess.run([recorder, session, content], check=True)
        messages = read_session.read_session(session.read_text())
        compare(messages, content.read_text().splitlines())
        damaged = bytearray(bytes.fromhex(session.read_text().splitlines()[0][2:]))
        damaged[5] ^= 4
        try:
            read_session.decode_frame(bytes(damaged))
            raise AssertionError("a damaged frame was accepted")
        except ValueError:
            pass
    # A recorded session of protocol 1.0 stays readable.
    kept = read_session.read_session(pathlib.Path(golden).read_text())
    assert len(kept) > 60 and {m["kind"] for m in kept} >= {0x81, 0x82, 0x85, 0x87, 0x40}
    print(f"{len(messages)} messages, {len(kept)} kept")


main()
