"""tactree.Board with a simulated board, whose time passes only while the test waits for it.

usage: board_test.py TACTREE
"""
import asyncio
import inspect
import json
import pathlib
import sys
import threading
import unittest

import numpy as np
import tactree

from clouds import ModelFolder, ServedBoard, runs_beside, signal_during, tool_error

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class Folder(ModelFolder):
    tool = TACTREE

    def tool_json(self, *arguments):
        done = self.run_tool(*arguments, "--json", "tool.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.path / "tool.json").read_text())


def another_thread_reads():
    frames = {thread: frame for thread, frame in sys._current_frames().items() if thread != threading.get_ident()}
    return any(frame.f_code.co_filename == inspect.getfile(tactree.Telemetry) for frame in frames.values())


class Control(Folder):
    def test_arm_stop_and_context(self):
        with ServedBoard(TACTREE, self.blob) as port:
            with tactree.Board(port) as board:
                self.assertTrue(board.is_open)
                self.assertEqual(board.status["state"], "idle")
                board.arm()
                self.assertEqual(board.status["state"], "active")
                board.stop()
                self.assertEqual(board.status["state"], "idle")
                board.arm()
                board.post_stop()
                board.wait(0.1)
                status = board.status
                self.assertEqual((status["state"], status["faults"], status["fault_names"]), ("idle", 0, ""))
                self.assertEqual(len(status["probe_m"]), 3)
                board.arm()
            self.assertFalse(board.is_open)
            with self.assertRaisesRegex(tactree.BoardError, "closed"):
                board.stop()
            with tactree.Board(port) as board:  # the end of the block has stopped it
                self.assertEqual(board.status["state"], "idle")

    def test_exception_stops_board(self):
        with ServedBoard(TACTREE, self.blob) as port:
            with self.assertRaises(ZeroDivisionError), tactree.Board(port) as board:
                board.arm()
                raise ZeroDivisionError
            self.assertEqual(self.tool_json("monitor", "--once", "--port", port)["state"], "idle")

    def test_replies_equal_tool(self):
        with ServedBoard(TACTREE, self.blob) as port:
            with tactree.Board(port) as board:
                parameters, identity, features = board.parameters, board.identity, board.capabilities
                self.assertIsNone(board.first_fault)
            self.assertEqual(parameters, self.tool_json("params", "--port", port))
            devices = self.run_tool("devices", "--port", port).stdout
            self.assertIn(identity["board"], devices)
            self.assertIn(identity["firmware"], devices)
            self.assertIn(identity["serial"], devices)
            self.assertEqual(features["rate_hz"], 1000)
            self.assertFalse(features["signature_required"])

    def test_settings(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            board.set_parameter("delay_s", 0.0005)
            self.assertAlmostEqual(board.parameters["delay_s"]["value"], 0.0005)
            board.set_limits(1.5, 100, 0.2)
            self.assertEqual(board.capabilities["force_max_N"], 1.5)
            board.set_material(250)
            self.assertEqual(board.capabilities["stiffness_N_m"], 250)
            board.set_texture(2e-4, 3e-3)
            for call, words in ((lambda: board.set_parameter("nonsense", 1), "no parameter 'nonsense'"),
                                (lambda: board.set_parameter("delay_s", 9), "set parameter: delay_s is 9, outside 0 .. 0.1"),
                                (lambda: board.set_parameter("delay_s", 0.09), "delay_s is 0.09, outside 0 .. 0.015"),
                                (lambda: board.set_parameter("velocity_cutoff_hz", 9000),
                                 "velocity_cutoff_hz is 9000, outside 1 .. 500"),
                                (lambda: board.set_parameter("device.ratio[0]", 0), "device.ratio[0] is 0"),
                                (lambda: board.set_limits(-1, 0, 0.2), "set limits: limits.force_max_N is -1, outside 0.01"),
                                (lambda: board.set_limits(900, 100, 0.2), "limits.force_max_N is 900, outside 0.01 .. "),
                                (lambda: board.set_limits(1.5, 1e5, 0.2), "limits.slew_N_s is 100000, outside "),
                                (lambda: board.set_limits(1.5, 100, 50), "limits.ramp_s is 50, outside 0.002 .. 10"),
                                (lambda: board.set_material(1e6), "contact.stiffness_N_m is 1e+06, outside 0 .. 100000"),
                                (lambda: board.set_material(5000), "with the present damping the limit is "),
                                (lambda: board.set_material(250, static_friction=0.1, dynamic_friction=0.2),
                                 "contact.dynamic_friction is 0.2, outside 0 .. 0.1"),
                                (lambda: board.set_texture(2e-3, 3e-3), "contact.texture_height_m is 0.002, outside 0 .. 0.0015")):
                with self.assertRaises(tactree.BoardError) as refused:
                    call()
                self.assertIn(words, str(refused.exception))

    def test_faults(self):
        with ServedBoard(TACTREE, self.blob, "--inject", "encoder1:disconnected@0s..0.3s") as port:
            with tactree.Board(port) as board:
                try:
                    board.arm()
                except tactree.BoardError as error:
                    self.assertIn("arm: ", str(error))
                board.wait(0.5)
                status = board.status
                self.assertEqual(status["state"], "fault")
                self.assertIn("encoder", status["fault_names"])
                self.assertEqual(board.first_fault["faults"], status["faults"])
                self.assertEqual(", ".join(tactree.fault_names(status["faults"])), status["fault_names"])
                board.clear_faults()
                self.assertEqual(board.status["state"], "idle")

    def test_flash_and_roll_back(self):
        models = [tactree.build_file(self.path / "ball.csv", spacing_m=spacing, unit="m") for spacing in (0.004, 0.005)]
        done = []

        def active_points():
            slots = self.tool_json("flash", "--list", "--port", port)["slots"]
            return [slot["points"] for slot in slots if slot["state"] == active]
        active = "in use"
        with ServedBoard(TACTREE, self.blob) as port:
            for model in models:
                with tactree.Board(port) as board:
                    board.flash(model, done.append)
                self.assertEqual(active_points(), [len(model)])
            with tactree.Board(port) as board:
                board.roll_back()
            self.assertEqual(active_points(), [len(models[0])])
        self.assertEqual(done.count(1), 2)
        self.assertTrue(all(0 < fraction <= 1 for fraction in done))

    def test_missing_port_error_equals_tool(self):
        run = self.run_tool("stop", "--port", "/dev/no-such-port")
        with self.assertRaises(tactree.BoardError) as refused:
            tactree.Board("/dev/no-such-port")
        self.assertEqual(str(refused.exception), tool_error(run))
        self.assertIsInstance(tactree.ports(), list)

    def test_ctrl_c_ends_wait_and_stops(self):
        with ServedBoard(TACTREE, self.blob) as port:
            with self.assertRaises(KeyboardInterrupt), tactree.Board(port) as board:
                board.arm()
                try:
                    with signal_during("wait"):
                        board.wait(20)
                finally:
                    self.assertLess(board.status["board_time_us"], 15e6)
            self.assertEqual(self.tool_json("monitor", "--once", "--port", port)["state"], "idle")

    def test_ctrl_c_ends_arming(self):
        # Of this board nobody holds the dead-man control.
        with ServedBoard(TACTREE, self.blob, "--inject", "deadman:released@0s") as port, tactree.Board(port) as board:
            with self.assertRaises(KeyboardInterrupt), signal_during("arm"):
                board.arm(patience_s=1e5)
            board.wait(0.1)
            self.assertEqual(board.status["state"], "idle")

    def test_other_threads_run_meanwhile(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            self.assertTrue(runs_beside(lambda: board.wait(1)))


class Stream(Folder):
    def test_blocks_have_every_tick(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            board.arm()
            telemetry = board.telemetry(every_ticks=1)
            blocks = []
            for block in telemetry:
                blocks.append(block)
                if sum(map(len, blocks)) >= 500:
                    break
            table = np.concatenate(blocks)
            self.assertEqual(table.dtype.names[:6], ("t_s", "tick", "missing_ticks", "state", "faults", "limits"))
            np.testing.assert_array_equal(np.diff(table["tick"]), 1)
            self.assertEqual(table["missing_ticks"].sum(), 0)
            self.assertEqual({tactree.STATES[state] for state in table["state"]}, {"active"})
            self.assertEqual(telemetry.dropped, 0)
            self.assertEqual(tactree.vectors(table, "force").shape, (len(table), 3))

    def test_async_for(self):
        async def watch(board):
            others = 0

            async def count():
                nonlocal others
                while True:
                    others += 1
                    await asyncio.sleep(0)
            counter = asyncio.ensure_future(count())
            rows = 0
            async for block in board.telemetry(every_ticks=10):
                self.assertTrue((np.diff(block["tick"]) == 10).all())
                rows += len(block)
                if rows >= 100:
                    break
            counter.cancel()
            return others
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            self.assertGreater(asyncio.run(watch(board)), 0)

    def test_cancelled_reads_lose_no_rows(self):
        async def watch(board):
            telemetry = board.telemetry(every_ticks=1)
            ticks, counted, cancelled = [], 0, 0
            while cancelled < 20:
                reading = asyncio.ensure_future(telemetry.read_async())
                for _ in range(1 + cancelled):
                    await asyncio.sleep(0)
                if reading.cancel():
                    cancelled += 1
                    await asyncio.sleep(0)
                    block = await telemetry.read_async() if cancelled % 2 else telemetry.read()
                else:
                    block = await reading
                ticks += list(block["tick"])
                counted += sum(block["missing_ticks"])
            return ticks, counted, telemetry.dropped
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            ticks, counted, dropped = asyncio.run(watch(board))
            np.testing.assert_array_equal(np.diff(ticks), 1)
            self.assertEqual((counted, dropped), (0, 0))

    def test_close_ends_cancelled_read(self):
        async def leave(port):
            for _ in range(20):
                with tactree.Board(port) as board:
                    telemetry = board.telemetry(every_ticks=4_000_000_000, timeout_s=1e6)
                    reading = asyncio.ensure_future(telemetry.read_async())
                    while not another_thread_reads():
                        await asyncio.sleep(0)
                    reading.cancel()
                with self.assertRaisesRegex(tactree.BoardError, "the board is closed"):
                    telemetry.read()
        with ServedBoard(TACTREE, self.blob) as port:
            asyncio.run(leave(port))
            self.assertEqual(self.tool_json("monitor", "--once", "--port", port)["state"], "idle")

    def test_other_subscription_ends_pending_read(self):
        async def change(board):
            for change in (lambda telemetry: telemetry.stop(), lambda _: board.telemetry(every_ticks=1)):
                telemetry = board.telemetry(every_ticks=4_000_000_000, timeout_s=1e6)
                reading = asyncio.ensure_future(telemetry.read_async())
                while not another_thread_reads():
                    await asyncio.sleep(0)
                change(telemetry)
                with self.assertRaisesRegex(tactree.BoardError, "the subscription has ended"):
                    await reading
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            asyncio.run(change(board))

    def test_ends_subscription(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            telemetry = board.telemetry(every_ticks=1)
            self.assertGreater(len(telemetry.read()), 0)
            telemetry.stop()
            with self.assertRaisesRegex(tactree.BoardError, "the subscription has ended"):
                telemetry.read()

    def test_rows_must_arrive_in_time(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            telemetry = board.telemetry(every_ticks=1000, timeout_s=0.2)
            with self.assertRaisesRegex(tactree.BoardError, "no telemetry for 0.2 s"):
                for _ in range(2):
                    telemetry.read()

    def test_lost_board_ends_blocks(self):
        with ServedBoard(TACTREE, self.blob, "--seconds", "1") as port:
            board = tactree.Board(port)
            rows = 0
            with self.assertRaisesRegex(tactree.BoardError, "the board is disconnected"):
                for block in board.telemetry(every_ticks=1):
                    rows += len(block)
            self.assertGreater(rows, 900)
            self.assertFalse(board.is_open)
            board.close()

    def test_other_session_ends_blocks(self):
        with ServedBoard(TACTREE, self.blob) as port, tactree.Board(port) as board:
            telemetry = board.telemetry(every_ticks=1)
            telemetry.read()
            with tactree.Board(port):
                with self.assertRaisesRegex(tactree.BoardError, "ended the session"):
                    while True:
                        telemetry.read()


if __name__ == "__main__":
    unittest.main(verbosity=2)
