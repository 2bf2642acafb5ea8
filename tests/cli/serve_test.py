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
                                       stdout=subprocess.PIPE, text=True)
            try:
                yield int(re.search(r"ws://127\.0\.0\.1:(\d+)/", program.stdout.readline())[1])
            finally:
                program.send_signal(signal.SIGTERM)
                self.said = program.communicate(timeout=30)[0]
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
                if state["tactree"]["force_N"]["x"] > 0.2:
                    break
            self.assertGreater(state["tactree"]["force_N"]["x"], 0.2)
            for _ in range(2000):  # of forces of zero, the last force ends
                program.send({})
                state = program.receive()
                if state["tactree"]["force_N"]["x"] == 0:
                    break
            self.assertEqual(state["tactree"]["force_N"]["x"], 0)
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

    def test_refuses_pages_of_other_servers(self):
        with self.served() as port:
            self.assertEqual(WebSocket(port, "http://evil.example").status, 403)

    def test_reports_cause_and_remedy(self):
        with self.served() as port, ServedBoard(TACTREE, self.blob) as other:
            done = self.run_tool("serve", "--port", other, "--tcp-port", port)
            self.assertEqual(done.returncode, 1)
            self.assertIn("choose another --tcp-port", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
