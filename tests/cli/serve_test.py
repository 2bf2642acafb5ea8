"""tactree serve with a simulated board: programs that know the public messages only, command, stop, refusals.

usage: serve_test.py TACTREE
"""
import contextlib
import pathlib
import re
import signal
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from served_board import BallFolder, ServedBoard  # noqa: E402
from web_socket import WebSocket  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def force(state, newton):
    return {"inverse3": [{"device_id": state["inverse3"][0]["device_id"],
                          "commands": {"set_cursor_force": {"values": {"x": newton, "y": 0, "z": 0}}}}]}


class Serve(BallFolder):
    tool = TACTREE

    @contextlib.contextmanager
    def served(self, *options):
        """The TCP port; self.said is the output of the program at the end."""
        with ServedBoard(TACTREE, self.blob) as port:
            program = subprocess.Popen([TACTREE, "serve", self.blob, "--port", port, "--tcp-port", "0", *options],
                                       stdout=subprocess.PIPE, text=True, cwd=self.path)
            try:
                self.address = re.search(r"ws://[\d.]+:(\d+)/[^;]*", program.stdout.readline())
                tcp_port = int(self.address[1])
                self.watch_port = re.search(r"unix:\S+", program.stdout.readline())[0]
                yield tcp_port
            finally:
                program.send_signal(signal.SIGTERM)
                self.said = program.communicate(timeout=30)[0]
            self.assertEqual(program.returncode, 0)

    def test_ends_at_once(self):
        with ServedBoard(TACTREE, self.blob) as port:
            for _ in range(5):
                program = subprocess.Popen([TACTREE, "serve", self.blob, "--port", port, "--tcp-port", "0"],
                                           stdout=subprocess.PIPE, text=True, cwd=self.path)
                program.stdout.readline()
                program.terminate()
                program.communicate(timeout=30)
                self.assertEqual(program.returncode, 0)

    def test_program_pushes_as_long_as_it_answers(self):
        with self.served("--arm") as port:
            program = WebSocket(port)
            state = program.receive()
            self.assertIn("config", state["inverse3"][0])
            self.assertIn("state", state["wireless_verse_grip"][0])
            self.assertEqual(state["tactree"]["model"]["points"] > 100, True)
            for _ in range(2000):
                program.send(force(state, 0.5))
                state = program.receive()
                if state["tactree"]["added_N"]["x"] > 0.2:
                    break
            self.assertGreater(state["tactree"]["added_N"]["x"], 0.2)
            for _ in range(2000):  # of forces of zero, the last force ends
                program.send({})
                state = program.receive()
                if state["tactree"]["added_N"]["x"] == 0:
                    break
            self.assertEqual(state["tactree"]["added_N"]["x"], 0)
            program.close()
        self.assertIn("client 1, 127.0.0.1:", self.said)

    def test_one_is_in_command_and_all_may_stop(self):
        with self.served("--grip", "none") as port:
            first, second = WebSocket(port), WebSocket(port)
            state = first.receive()
            self.assertEqual(state["wireless_verse_grip"], [])
            second.receive()
            first.send({"tactree": {"arm": True}})
            for _ in range(5000):
                state = first.receive()
                if state["tactree"]["state"] == "active":
                    break
                first.send({})
            self.assertEqual(state["tactree"]["state"], "active")
            second.send(force(state, 0.5))
            refused = second.receive()["tactree"]["client"]["refused"]
            self.assertRegex(refused, r"client 1, 127\.0\.0\.1:\d+, has command since \d+ s")
            second.send({"tactree": {"stop": True, "subscribe": {"rate_hz": 100}}})
            for _ in range(500):
                if second.receive()["tactree"]["state"] == "idle":
                    break
            else:
                self.fail("not stopped")
            first.close()
            second.close()

    def test_tools_watch_and_stop_beside_the_program_in_command(self):
        with self.served("--arm") as port:
            program = WebSocket(port)
            program.receive()
            table = self.path / "session.csv"
            recorded = self.run_tool("record", "--port", self.watch_port, "--seconds", "1", "-o", table)
            self.assertEqual(recorded.returncode, 0, recorded.stderr)
            rows = [line for line in table.read_text().splitlines() if line[:1].isdigit()]
            self.assertGreater(len(rows), 900, recorded.stderr)
            watched = self.run_tool("monitor", "--port", self.watch_port, "--once")
            self.assertIn("shared by tactree serve: this program may watch and stop", watched.stdout)
            self.assertIn(self.watch_port, self.run_tool("devices").stdout)
            probed = self.run_tool("devices", "--port", self.watch_port).stdout
            self.assertIn("a program may only watch and stop it: another program shares it", probed)
            self.assertNotIn("button", probed)
            refused = self.run_tool("arm", "--port", self.watch_port)
            self.assertEqual(refused.returncode, 1)
            self.assertIn("shared by tactree serve", refused.stderr)
            program.send({})
            self.assertEqual(program.receive()["tactree"]["state"], "active")
            stopped = self.run_tool("stop", "--port", self.watch_port)
            self.assertEqual(stopped.returncode, 0, stopped.stderr)
            for _ in range(500):
                program.send({})
                if program.receive()["tactree"]["state"] == "idle":
                    break
            else:
                self.fail("not stopped")
            program.close()
        self.assertIn("watching program 1: has left", self.said)
        self.assertFalse(pathlib.Path(self.watch_port[5:]).exists())

    def test_refuses_pages_of_other_servers(self):
        with self.served() as port:
            self.assertEqual(WebSocket(port, "http://evil.example").status, 403)

    def test_demands_a_token_of_programs_on_the_network(self):
        with self.served("--address", "0.0.0.0") as port:
            token = re.search(r"\?token=([0-9a-f]{32})$", self.address[0])[1]
            for path in ("/", "/?token=", f"/?token={token[:-1]}", f"/?token={token}0", f"/?broken={token}"):
                self.assertEqual(WebSocket(port, path=path, host="127.0.0.1").status, 401, path)
            self.assertEqual(WebSocket(port, host="127.0.0.1", token=token[::-1]).status, 401)
            for program in (WebSocket(port, path=f"/?x=1&token={token}", host="127.0.0.1"),
                            WebSocket(port, host="127.0.0.1", token=token)):
                self.assertIn("state", program.receive()["tactree"])
                program.close()

    def test_takes_the_token_of_a_file(self):
        (self.path / "token").write_text("a_token-of-16letters\n")
        with self.served("--token-file", "token") as port:
            self.assertEqual(WebSocket(port).status, 401)
            WebSocket(port, token="a_token-of-16letters").close()
        (self.path / "token").write_text("short\n")
        done = self.run_tool("serve", "--port", "step:/nowhere", "--token-file", "token")
        self.assertEqual(done.returncode, 1)
        self.assertIn("token: no token (write a line of at least 16", done.stderr)

    def test_reports_cause_and_remedy(self):
        with self.served() as port, ServedBoard(TACTREE, self.blob) as other:
            done = self.run_tool("serve", "--port", other, "--tcp-port", port)
            self.assertEqual(done.returncode, 1)
            self.assertIn("choose another --tcp-port", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
