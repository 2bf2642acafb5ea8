"""The server of `tactree view` from outside: content, refusals, clients that never read.

usage: server_test.py TACTREE
"""
import base64
import json
import math
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request
import zipfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from served_board import ServedBoard, build_ball  # noqa: E402

TACTREE = sys.argv.pop(1)
SKIPPED = 77


class Server:
    def __init__(self, *arguments):
        self.process = subprocess.Popen([TACTREE, "view", *arguments, "--page-port", "0"],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"http://(\S+):(\d+)/", line)
        if not found:
            raise RuntimeError(line + self.process.stderr.read())
        self.port = int(found[2])
        self.host = f"{found[1]}:{self.port}"

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(timeout=20)
        self.process.stdout.close()
        self.process.stderr.close()
        return code

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=20)

    def get(self, path, **headers):
        """Status and body."""
        request = urllib.request.Request(f"http://{self.host}{path}", headers=headers)
        try:
            with urllib.request.urlopen(request, timeout=20) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.read()

    def raw(self, request):
        """The status code of the answer to these bytes; 0 if the connection is closed without one."""
        with self.connect() as connection:
            connection.sendall(request)
            try:
                answer = connection.recv(65536)
            except ConnectionResetError:
                return 0
            return int(answer.split(b" ")[1]) if answer.startswith(b"HTTP/") else 0


class Page:
    """A WebSocket opened like one of a page."""

    def __init__(self, server, origin=None, host=None, receive_buffer=None):
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(20)
        self.socket.connect(("127.0.0.1", server.port))
        key = base64.b64encode(os.urandom(16)).decode()
        lines = ["GET /live HTTP/1.1", f"Host: {host or server.host}", "Upgrade: websocket",
                 "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if origin != "":
            lines.append(f"Origin: {origin or 'http://' + server.host}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += self.socket.recv(1)
        self.status = int(answer.split(b" ")[1])

    def send(self, payload, opcode=1, mask=True):
        data = payload.encode() if isinstance(payload, str) else payload
        size = len(data)
        bit = 0x80 if mask else 0
        head = struct.pack("!BB", 0x80 | opcode, bit | size) if size < 126 else (
            struct.pack("!BBH", 0x80 | opcode, bit | 126, size) if size < 65536 else
            struct.pack("!BBQ", 0x80 | opcode, bit | 127, size))
        key = b"\x01\x02\x03\x04" if mask else b""
        body = bytes(b ^ key[i % 4] for i, b in enumerate(data)) if mask else data
        self.socket.sendall(head + key + body)

    def take(self, count):
        data = b""
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise ConnectionError("ended")
            data += part
        return data

    def receive(self):
        """Opcode and payload of the next message."""
        head = self.take(2)
        size = head[1] & 0x7F
        if size == 126:
            size = struct.unpack("!H", self.take(2))[0]
        elif size == 127:
            size = struct.unpack("!Q", self.take(8))[0]
        return head[0] & 0x0F, self.take(size)

    def wait_for(self, kind):
        while True:
            opcode, payload = self.receive()
            if opcode == 8:
                raise ConnectionError(f"closed: {payload[:2].hex()}")
            if opcode == 9:  # as every browser does; a page that does not is closed after a minute
                self.send(payload, opcode=10)
            if opcode == 1:
                message = json.loads(payload)
                if message["type"] == kind:
                    return message

    def say(self, **command):
        self.send(json.dumps(command))

    def close(self):
        self.socket.close()


class ServerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.blob = build_ball(TACTREE, pathlib.Path(cls.folder.name), points=8000, radius=0.04)
        # Half the default rate: with sanitizers the simulation takes most of a processor.
        cls.server = Server(cls.blob, "--rate", "500")

    @classmethod
    def tearDownClass(cls):
        cls.server.stop()
        cls.folder.cleanup()

    def still_serves(self):
        self.assertEqual(self.server.get("/")[0], 200)

    def test_serves_the_page_and_nothing_else(self):
        for path in ("/", "/assets/page.js", "/assets/page.css", "/faults/", "/faults/encoder-stuck",
                     "/faults/limit-force", "/model/0", "/model/0/points/0", "/model/0/octants/3",
                     "/status.json", "/trace.csv"):
            self.assertEqual(self.server.get(path)[0], 200, path)
        for path in ("/etc/passwd", "/../../etc/passwd", "/assets/../../etc/passwd", "/%2e%2e/etc/passwd",
                     "/faults/../../README", "/faults/..%2fREADME", "/assets/", "/model", "/model/1",
                     "/model/0/points/99999", "/model/0/points/-1", "/model/0/points/0/0", "/model/x",
                     "/model/0/points/99999999999999999999", "/index.html", "//", "/faults/README.md"):
            self.assertEqual(self.server.get(path)[0], 404, path)

    def test_pages_load_no_external_resources(self):
        for path in ("/", "/assets/page.css", "/faults/encoder-stuck"):
            body = self.server.get(path)[1].decode()
            self.assertNotRegex(body, r"(src|href)=[\"']?(https?:)?//|url\((https?:)?//|@import", path)

    def test_nodes_together_hold_all_points(self):
        tree = json.loads(self.server.get("/model/0")[1])
        total = 0
        for number, node in enumerate(tree["nodes"]):
            body = self.server.get(f"/model/0/points/{number}")[1]
            self.assertEqual(len(body), 8 * node["points"])
            total += node["points"]
            for i in range(0, len(body), 8 * 97):
                place = [node["min_m"][k] + node["edge_m"] * w / 65535
                         for k, w in enumerate(struct.unpack_from("<HHH", body, i))]
                self.assertAlmostEqual(math.hypot(*place), 0.04, delta=2e-4)
        self.assertEqual(total, tree["points"])

    def test_fault_pages_are_html(self):
        body = self.server.get("/faults/encoder-stuck")[1].decode()
        self.assertIn("<h1>", body)
        self.assertIn("<code>stuck_s</code>", body)
        self.assertIn('href="/faults/encoder-stuck"', self.server.get("/faults/")[1].decode())

    def test_refuses_other_names_and_origins(self):
        self.assertEqual(self.server.get("/", Host="evil.example")[0], 421)
        self.assertEqual(self.server.get("/", Host=f"localhost:{self.server.port}")[0], 200)
        self.assertEqual(self.server.get("/trace.csv", Origin="http://evil.example")[0], 403)
        for origin in ("http://evil.example", "", "null", "https://" + self.server.host,
                       f"http://localhost:{self.server.port}",
                       f"http://{self.server.host}.evil.example"):
            page = Page(self.server, origin=origin)
            self.assertEqual(page.status, 403, origin)
            page.close()
        page = Page(self.server, host="evil.example")
        self.assertEqual(page.status, 421)
        page.close()
        self.assertEqual(self.server.get("/live")[0], 426)

    def test_refuses_malformed_requests(self):
        host = self.server.host.encode()
        self.assertEqual(self.server.raw(b"POST / HTTP/1.1\r\nHost: " + host + b"\r\n\r\n"), 405)
        self.assertEqual(self.server.raw(b"DELETE / HTTP/1.1\r\nHost: " + host + b"\r\n\r\n"), 405)
        self.assertEqual(self.server.raw(b"GET / HTTP/1.1\r\n\r\n"), 421)
        for request in (b"nonsense\r\n\r\n", b"GET\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
                        b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nX: " + b"a" * 20000 + b"\r\n\r\n",
                        b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nContent-Length: 5000000\r\n\r\nxxxxx"):
            self.assertIn(self.server.raw(request), (0, 400), request[:20])
        self.still_serves()

    def test_refuses_oversize_and_malformed_messages(self):
        for payload, opcode, mask in (("x" * 100000, 1, True), (b"\xff\xfe", 1, True), ("{}", 1, False),
                                      ("{}", 3, True)):
            page = Page(self.server)
            page.wait_for("hello")
            try:
                page.send(payload, opcode, mask)
                with self.assertRaises((ConnectionError, OSError)):
                    while True:
                        page.wait_for("never")
            except (BrokenPipeError, ConnectionResetError):
                pass
            page.close()
        self.still_serves()

    def test_refuses_invalid_commands(self):
        page = Page(self.server)
        page.wait_for("hello")
        for command in ('not json', '[]', '{"do": 7}', '{"do": "fly"}', '{"do": "hand"}',
                        '{"do": "hand", "target_m": [1, 2]}', '{"do": "hand", "target_m": [1e9, 0, 0]}',
                        '{"do": "hand", "target_m": ["a", 0, 0]}', '{"do": "set", "rate_hz": 1}',
                        '{"do": "set", "rate_hz": "fast"}', '{"do": "set", "device": "../etc/passwd"}',
                        '{"do": "set", "stiffness_N_m": 1e9}', '{"do": "set", "mode": "fast"}',
                        '{"do": "inject", "fault": "world:ends"}', '{"do": "seek", "tick": 1}'):
            page.send(command)
            self.assertTrue(page.wait_for("refused")["why"], command)
        page.close()

    def test_the_hand_touches(self):
        page = Page(self.server)
        page.say(do="arm")
        page.say(do="hand", target_m=[0, 0, 0.06])
        frame = page.wait_for("frame")
        for _ in range(600):
            frame = page.wait_for("frame")
            if frame["runs"][0]["state"] == "active" and frame["hand_m"][2] < 0.061:
                break
        page.say(do="hand", target_m=[0, 0, 0.035])
        for _ in range(600):
            run = page.wait_for("frame")["runs"][0]
            if run["penetration_m"] > 5e-4:
                break
        self.assertGreater(run["force_N"][2], 0.1)
        self.assertGreater(len(run["candidates"]), 3)
        page.say(do="hand", target_m=[0, 0, 0.07])
        page.close()

    def test_a_page_that_never_reads_delays_nothing(self):
        stalled = Page(self.server, receive_buffer=4096)
        reading = Page(self.server)
        reading.wait_for("hello")

        def status():
            return json.loads(self.server.get("/status.json")[1])["frames"]

        before = status()["dropped"]
        for _ in range(100):
            if status()["dropped"] - before >= 30:
                break
            stalled.send(b"", opcode=10)  # a page that is silent for a minute is closed, however few frames it missed
            for _ in range(30):
                reading.wait_for("frame")
        now = status()
        self.assertGreaterEqual(now["dropped"] - before, 30, "no frame was dropped")
        # The source and the other page continue.
        first = reading.wait_for("frame")
        for _ in range(60):
            last = reading.wait_for("frame")
        self.assertGreater(last["t_s"], first["t_s"])
        self.assertGreater(status()["offered"], now["offered"])
        print(f"frames: {status()}", file=sys.stderr)
        stalled.close()
        reading.close()

    def test_refuses_too_many_pages(self):
        pages = [Page(self.server) for _ in range(16)]
        for page in pages:
            page.wait_for("hello")
        with self.assertRaises((ConnectionError, OSError)):
            extra = Page(self.server)
            extra.wait_for("hello")
        for page in pages:
            page.close()
        self.still_serves()

    def test_listens_on_loopback_only(self):
        table = pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]
        listening = [row.split()[1] for row in table if row.split()[3] == "0A"]
        port = f"{self.server.port:04X}"
        self.assertEqual([a for a in listening if a.endswith(":" + port)], ["0100007F:" + port])

    def test_address_option_accepts_addresses_but_no_names(self):
        server = Server(self.blob, "--address", "0.0.0.0")
        server.host = f"127.0.0.1:{server.port}"
        self.assertEqual(server.get("/")[0], 200)
        self.assertEqual(server.get("/", Host=f"192.168.1.2:{server.port}")[0], 200)
        self.assertEqual(server.get("/", Host=f"evil.example:{server.port}")[0], 421)
        self.assertEqual(server.get("/", Host="127.0.0.1:1")[0], 421)
        page = Page(server, origin=f"http://evil.example:{server.port}")
        self.assertEqual(page.status, 403)
        page.close()
        server.stop()

    def test_stops_right_after_its_start(self):
        for _ in range(5):
            self.assertEqual(Server(self.blob).stop(), 0)

    def test_stops_on_a_signal(self):
        server = Server(self.blob)
        page = Page(server)
        page.wait_for("hello")
        self.assertEqual(server.stop(), 0)
        page.close()

    def test_reports_invalid_options(self):
        def run(*arguments):
            done = subprocess.run([TACTREE, "view", *arguments], capture_output=True, text=True, timeout=120)
            return done.returncode, done.stderr
        folder = pathlib.Path(self.folder.name)
        cut = folder / "cut.csv"
        cut.write_text("t_s,probe_x_m,probe_y_m,probe_z_m,force_x_N,force_y_N,force_z_N\n0,0,0,0,0,0,0\n1,2\n")
        other = folder / "other.csv"
        other.write_text("a,b\n1,2\n")
        for arguments, words in (((self.blob, "--page-port", str(self.server.port)), "choose another --page-port"),
                                 ((self.blob, "--address", "nowhere"), "is not an IP address"),
                                 ((self.blob, "--stiffness", "90000"), "stability limit"),
                                 ((self.blob, "--trace", cut), "line 3: 2 values"),
                                 ((self.blob, "--trace", other), "no column t_s"),
                                 ((self.blob, "--trace", folder / "none.csv"), "cannot be read"),
                                 ((folder / "none.blob",), "none.blob"),
                                 ((self.blob, "--port", "/dev/no-such-port"), "/dev/no-such-port"),
                                 ((self.blob, "--port", "none", "--recording", "a.rec"), "a.rec: a .rec holds"),
                                 ((self.blob, "--port", "none", "--recording", "/dev/null"), "records to a file"),
                                 ((self.blob, self.blob, "--port", "/dev/no-such-port"), "give one BLOB")):
            code, text = run(*arguments)
            self.assertEqual(code, 1, arguments)
            self.assertIn(words, text)
        for arguments, words in ((("--port", "8023"), "--page-port 8023"),
                                 (("--port", "/dev/no-such-port", "--stiffness", "300"), "--stiffness"),
                                 (("--link-timeout", "20"), "--port")):
            code, text = run(self.blob, *arguments)
            self.assertEqual(code, 2, arguments)
            self.assertIn(words, text)


class BoardRecording(unittest.TestCase):
    def test_records_as_the_command_and_shows_the_file(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            blob = build_ball(TACTREE, folder)
            with ServedBoard(TACTREE, blob) as port:
                server = Server(blob, "--port", port, "--recording", folder / "page.npz")
                self.record(Page(server))
                self.assertEqual(server.stop(), 0)
                command = subprocess.run([TACTREE, "record", "--port", port, "--seconds", "0.1", "-o",
                                          folder / "command.npz"], capture_output=True, text=True)
                self.assertEqual(command.returncode, 0, command.stderr)
            with zipfile.ZipFile(folder / "page.npz") as page, zipfile.ZipFile(folder / "command.npz") as other:
                self.assertEqual(page.namelist(), other.namelist())
            server = Server(blob, "--trace", folder / "page.npz")
            rows = server.get("/trace.csv")[1].decode().splitlines()
            server.stop()
            self.assertGreater(len(rows), 500)

    def record(self, page):
        page.wait_for("hello")
        page.say(do="record")
        ticks = 0
        while ticks < 500:
            recording = page.wait_for("frame")["recording"]
            ticks = int((re.search(r": (\d+) ticks", recording["text"]) or [0, 0])[1])
        self.assertIn("none missing", recording["text"])
        page.say(do="end_recording")
        while page.wait_for("frame")["recording"]["state"] != "off":
            pass
        page.close()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        probe = subprocess.run([TACTREE, "view", build_ball(TACTREE, pathlib.Path(place)), "--address", "nowhere"],
                               capture_output=True, text=True)
    if "built without its page" in probe.stderr:
        print("skipped: the page was not built (scripts/install-deps view)")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
