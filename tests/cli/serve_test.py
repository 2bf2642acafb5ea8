"""tactree serve with a simulated board: programs that know the public messages only, command, stop, refusals, rates,
programs that hang or are killed.

usage: serve_test.py TACTREE CLASS        CLASS: Serve, Rates or Hung
"""
import contextlib
import json
import pathlib
import re
import subprocess
import sys
import threading
import unittest

sys.dont_write_bytecode = True
from served_board import BallFolder, RealTimeBoard, ServedBoard, SharingProgram, subscribe  # noqa: E402
from web_socket import WebSocket  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def force(state, newton):
    return {"inverse3": [{"device_id": state["inverse3"][0]["device_id"],
                          "commands": {"set_cursor_force": {"values": {"x": newton, "y": 0, "z": 0}}}}]}


class Shared(BallFolder):
    tool = TACTREE

    @contextlib.contextmanager
    def served(self, *options, board=ServedBoard):
        """The TCP port; self.said is the output of the program at the end."""
        with board(TACTREE, self.blob) as self.port:
            with SharingProgram(TACTREE, self.blob, "--port", self.port, *options, cwd=self.path) as self.program:
                self.address, self.watch_port = self.program.address, self.program.watch_port
                yield self.program.tcp_port
        self.said = self.program.said


class Serve(Shared):

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

    def test_force_moves_the_cursor_of_a_program_that_knows_the_public_fields_only(self):
        def mean_x(newton):
            """Of a second, in which the simulated hand moves along its whole path."""
            nonlocal state
            positions = []
            for _ in range(1000):
                program.send(force(state, newton))
                state = public(program.receive())
                positions.append(state["inverse3"][0]["state"]["cursor_position"]["x"])
            return sum(positions) / len(positions)

        def public(message):
            return {name: message[name] for name in ("inverse3", "wireless_verse_grip")}
        with self.served("--arm") as port:
            program = WebSocket(port)
            state = public(program.receive())
            self.assertEqual(state["inverse3"][0]["config"]["handedness"], "right")
            self.assertEqual(set(state["wireless_verse_grip"][0]["state"]), {"orientation", "buttons"})
            self.assertGreater(mean_x(2.0) - mean_x(-2.0), 0.005)
            program.close()

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
            self.assertIn("its terminal names the program in command", refused.stderr)
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

    def test_page_watches_beside_the_program_in_command(self):
        with self.served("--arm") as port:
            program = WebSocket(port)
            program.receive()
            viewer = subprocess.Popen([TACTREE, "view", self.blob, "--port", self.watch_port, "--page-port", "0"],
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=self.path)
            page_port = int(re.search(r"http://127\.0\.0\.1:(\d+)/", viewer.stdout.readline())[1])
            page = WebSocket(page_port, f"http://127.0.0.1:{page_port}", "/live", "127.0.0.1")
            while (message := page.receive())["type"] != "frame":
                pass
            self.assertEqual((message["board"]["link"], message["runs"][0]["state"]), ("here", "active"))
            page.close()
            viewer.terminate()
            self.assertEqual(viewer.wait(), 0)
            viewer.stdout.close()
            program.close()

    def test_takes_binary_messages(self):
        """As JSON libraries that write bytes send them."""
        with self.served("--arm") as port:
            program = WebSocket(port)
            state = program.receive()
            for _ in range(2000):
                program.send(json.dumps(force(state, 0.5)).encode(), opcode=2)
                state = program.receive()
                if state["tactree"]["added_N"]["x"] > 0.2:
                    break
            self.assertGreater(state["tactree"]["added_N"]["x"], 0.2)
            program.close()

    def test_tells_programs_that_are_too_many(self):
        with self.served() as port:
            programs = [WebSocket(port) for _ in range(32)]
            for program in programs:
                program.receive()
            refused = WebSocket(port)
            self.assertEqual(refused.receive()["tactree"]["client"]["refused"], "there are 32 clients already (end one)")
            with self.assertRaisesRegex(ConnectionError, "closed"):
                refused.receive()
            programs.pop().close()
            self.program.wait_for("client 32, .*: disconnected")
            programs.append(WebSocket(port))
            programs[-1].receive()
            for program in (*programs, refused):
                program.close()

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


class Rates(Shared):
    """In the time of the board, which it keeps itself."""

    def expect_rate(self, program, seconds, rate_hz):
        texts = [program.receive_text()]
        first = last = json.loads(texts[0])["tactree"]
        while last["time_us"] < first["time_us"] + 1e6 * seconds:
            texts += [program.receive_text() for _ in range(20)]
            last = json.loads(texts[-1])["tactree"]
        self.assertGreaterEqual((len(texts) - 1) / (last["time_us"] - first["time_us"]) * 1e6, 0.99 * rate_hz)

    def test_subscription_gets_each_tick(self):
        with self.served(board=RealTimeBoard) as port:
            program = subscribe(port, 1000, queue=64)
            self.expect_rate(program, 2, 1000)
            program.close()

    def test_ten_programs_get_200_states_a_second(self):
        with self.served(board=RealTimeBoard) as port:
            programs = [subscribe(port, 200, queue=64) for _ in range(10)]
            failures = []

            def read(program):
                try:
                    self.expect_rate(program, 2, 200)
                except AssertionError as error:
                    failures.append(str(error))
            threads = [threading.Thread(target=read, args=[program]) for program in programs]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            for program in programs:
                program.close()
        self.assertEqual(failures, [])

    def test_answering_program_gets_each_tick(self):
        with self.served(board=RealTimeBoard) as port:
            program = WebSocket(port)
            first = last = program.receive()["tactree"]
            states = 0
            while last["time_us"] < first["time_us"] + 2e6:
                for _ in range(20):
                    program.send({})
                    text = program.receive_text()
                    states += 1
                last = json.loads(text)["tactree"]
            program.close()
        ticks = last["tick"] - first["tick"]
        self.assertGreaterEqual(states, 0.95 * ticks)
        self.assertLessEqual(states, ticks)  # none twice

    def test_silent_reader_delays_nobody_and_is_disconnected(self):
        with self.served("--arm", board=RealTimeBoard) as port:
            silent = subscribe(port, 1000, queue=1024)
            pushing = WebSocket(port)
            state = pushing.receive()
            for _ in range(1000):
                pushing.send(force(state, 0.5))
                state = pushing.receive()
            self.assertGreater(state["tactree"]["added_N"]["x"], 0.2)
            watching = subscribe(port, 1000, queue=64)
            self.expect_rate(watching, 2, 1000)
            line = self.program.wait_for(r"(client \d+), .*because it has read nothing for 5 s; (\d+) states")
            self.assertEqual(line[1], "client 1")
            self.assertGreater(int(line[2]), 100)
            for program in (silent, pushing, watching):
                program.close()


class Hung(Shared):
    def pushed(self, port):
        """A program whose force acts."""
        program = WebSocket(port)
        state = program.receive()
        while state["tactree"]["added_N"]["x"] < 0.2:
            program.send(force(state, 0.5))
            state = program.receive()
        return program

    def test_force_of_silent_program_ends(self):
        with self.served("--arm") as port:
            watching = subscribe(port, 1000, queue=1024)
            silent = self.pushed(port)
            while watching.receive()["tactree"]["added_N"]["x"] < 0.2:
                pass
            acted_us = []
            while (state := watching.receive()["tactree"])["added_N"]["x"] > 0:
                acted_us.append(state["time_us"])
            self.assertLess(acted_us[-1] - acted_us[0], 0.3e6)  # 0.1 s, and the pushes before
            self.assertEqual(state["state"], "active")  # the board still renders the model
            silent.close()
            watching.close()

    def test_silent_program_in_command_loses_it(self):
        with self.served("--arm") as port:
            silent = self.pushed(port)
            watching = subscribe(port, 20)
            self.assertIsNotNone(watching.receive()["tactree"]["command"])
            name = self.program.wait_for(r"client (\d+), .*: has command")[1]
            while watching.receive()["tactree"]["command"] is not None:
                pass
            line = self.program.wait_for("has answered nothing for 10 s")
            self.assertIn(f"client {name}, ", line.string)
            silent.close()
            watching.close()

    def test_answering_a_ping_keeps_command(self):
        """A program that sends nothing else, for instance because its user thinks."""
        with self.served() as port:
            thinking = WebSocket(port)
            thinking.receive()
            thinking.send({"tactree": {"take_command": True}})
            self.program.wait_for("has command")
            watching = subscribe(port, 20)
            pings = []

            def answer():
                while True:
                    try:
                        opcode, data = thinking.receive_frame()
                    except OSError:
                        return
                    if opcode == 9:
                        pings.append(data)
                        thinking.send(data, opcode=10)
            thread = threading.Thread(target=answer)
            thread.start()
            begin = watching.receive()["tactree"]["time_us"]
            while (state := watching.receive()["tactree"])["time_us"] < begin + 14e6:
                self.assertIsNotNone(state["command"])
            thinking.end()
            thread.join()
            watching.close()
        self.assertGreater(len(pings), 1)

    def test_board_stops_when_the_program_is_killed(self):
        with self.served("--arm", board=RealTimeBoard) as port:
            pushing = self.pushed(port)
            self.program.process.kill()
            self.program.process.wait()
            while "the controller is armed" in (found := self.run_tool("monitor", "--port", self.port, "--once")).stderr:
                pass  # until the link counts as lost, 50 ms
            self.assertRegex(found.stdout, "fault.*link-lost", found.stderr)
            pushing.close()

    def test_socket_of_a_killed_program_is_used_again(self):
        socket = ["--watch-socket", self.path / "watch"]
        with self.served(*socket):
            with ServedBoard(TACTREE, self.blob) as other:
                done = self.run_tool("serve", "--port", other, "--tcp-port", "0", *socket)
            self.assertEqual(done.returncode, 1)
            self.assertIn("watch: Address already in use (choose another --watch-socket)", done.stderr)
            self.program.process.kill()
        self.assertTrue((self.path / "watch").is_socket())
        with self.served(*socket):
            self.assertEqual(self.run_tool("monitor", "--once", "--port", self.watch_port).returncode, 0)
        (self.path / "watch").write_text("a file of the user")
        with ServedBoard(TACTREE, self.blob) as other:
            self.assertEqual(self.run_tool("serve", "--port", other, "--tcp-port", "0", *socket).returncode, 1)
        self.assertEqual((self.path / "watch").read_text(), "a file of the user")


if __name__ == "__main__":
    unittest.main(verbosity=2)
