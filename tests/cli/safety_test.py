"""The campaign of docs/SAFETY.md, short: each requirement on faults, in every situation.

usage: safety_test.py TACTREE
"""
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from pages.safety import Campaign  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
FORCE_MAX_N = 8.0
TICK_S = 1e-3


class Safety(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            cls.rows = Campaign(TACTREE, folder, 2).rows()

    def test_injects_every_fault_everywhere(self):
        self.assertEqual({r["situation"] for r in self.rows}, {"free", "contact", "full force"})
        self.assertGreaterEqual(len({r["what"] for r in self.rows}), 17)
        full = [r["force_max_N"] for r in self.rows if r["situation"] == "full force"]
        self.assertGreater(max(full), 0.99 * FORCE_MAX_N)

    def test_keeps_force_limit_under_faults(self):
        for row in self.rows:
            self.assertLessEqual(row["force_max_N"], FORCE_MAX_N, row)

    def test_required_detections_end_force(self):
        promised = [r for r in self.rows if r["promised"]]
        self.assertGreaterEqual(len(promised), 21)
        for row in promised:
            self.assertEqual(row["detected"], row["times"], row)
            self.assertEqual(row["faults"], [row["promised"]], row)
            self.assertLessEqual(row["detected_s"], 2 * TICK_S, row)
            self.assertEqual(row["force_max_N"], 0.0, row)

    def test_reports_no_other_fault(self):
        for row in self.rows:
            if not row["promised"]:
                self.assertLessEqual(set(row["faults"]), {"encoder-stuck"}, row)


if __name__ == "__main__":
    unittest.main(verbosity=2)
