"""tactree.Board at a board that tactree serve shares: it watches and stops.

usage: share_test.py TACTREE
"""
import pathlib
import sys
import unittest

import numpy as np
import tactree

from clouds import ModelFolder, ServedBoard, SharingProgram

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class Share(ModelFolder):
    tool = TACTREE

    def test_watches_and_stops(self):
        with ServedBoard(TACTREE, self.blob) as port, SharingProgram(TACTREE, "--port", port, "--arm") as shared:
            with tactree.Board(shared.watch_port) as board:
                self.assertTrue(board.capabilities["shared"])
                self.assertTrue(board.capabilities["watch_only"])
                self.assertEqual(board.status["state"], "active")
                telemetry = board.telemetry(every_ticks=1)
                block = np.concatenate([telemetry.read() for _ in range(20)])
                np.testing.assert_array_equal(np.diff(block["tick"]), 1)
                self.assertGreater(np.ptp(tactree.vectors(block, "probe")), 0)
                for refused in (board.arm, board.clear_faults, lambda: board.set_material(250)):
                    with self.assertRaisesRegex(tactree.BoardError, "shared by tactree serve"):
                        refused()
                self.assertEqual(board.status["state"], "active")
                board.stop()
                self.assertEqual(board.status["state"], "idle")


if __name__ == "__main__":
    unittest.main(verbosity=2)
