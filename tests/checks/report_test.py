"""scripts/test-report: what ctest reports is counted, skips are named, and a test that is missing fails the gate."""
import pathlib
import re
import subprocess
import tempfile
import unittest

REPORT = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts/test-report"
CASES = """<testsuite>
<testcase name="Gate.Holds" time="0.5" status="run"><system-out>fine</system-out></testcase>
<testcase name="Gate.Limits" time="1.5" status="run"/>
<testcase name="Gate.Fails" time="0" status="fail"><failure message=""/><system-out>a.cpp:7: Failure</system-out></testcase>
<testcase name="Gate.NeedsRoot  # GetParam() = 0x55d0a1" time="0" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
<system-out>/a.cpp:9: Skipped
not as root
</system-out></testcase>
<testcase name="web.page" time="0" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>
<system-out>skipped: chromium is missing</system-out></testcase>
<testcase name="web.board" time="0" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>
<system-out>skipped: a part of it

skipped: inconclusive: the machine stalled for 512 ms while it ran</system-out></testcase>
<testcase name="not.built" time="0" status="notrun"><skipped message="Unable to find executable"/></testcase>
<testcase name="cli.link" time="2" status="run"><system-out>test_a (__main__.Link.test_a) ... ok
test_key (__main__.Link.test_key) ... skipped 'no key'
OK (skipped=1)</system-out></testcase>
</testsuite>"""


class TestReport(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "host.xml").write_text(CASES)
        (self.folder / "steps.tsv").write_text("host\t4\nbuild\t300\n")
        self.list = self.folder / "list"

    def report(self, command, *arguments, code=0):
        done = subprocess.run([REPORT, command, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def test_counts_outcomes(self):
        self.assertEqual(self.report("count", self.folder / "host.xml"), "3 2 4\n")
        self.assertEqual(self.report("count", self.folder / "absent.xml"), "0 0 0\n")

    def test_prints_output_of_failures(self):
        failures = self.report("failures", self.folder / "host.xml")
        self.assertIn("a.cpp:7: Failure", failures)
        self.assertIn("not.built Unable to find executable", failures)
        self.assertNotIn("fine", failures)

    def test_names_skips_with_their_reason(self):
        self.assertEqual(self.report("skips", self.folder).splitlines(), [
            "Gate.NeedsRoot (not as root)", "cli.link: test_key (no key)",
            "web.board (inconclusive: the machine stalled for 512 ms while it ran)", "web.page (chromium is missing)"])

    def test_compares_forces_of_suites(self):
        logs = []
        for suite, checksum in (("bookworm", 7), ("trixie", 7), ("forky", 8)):
            logs.append(self.folder / f"{suite}.log")
            logs[-1].write_text("Setting up clang\n" + "".join(
                f"ok      {suite} {build}: forces {checksum}, {build} (Debian) 12\n" for build in ("g++/Debug", "clang++/Debug")))
        self.assertEqual(self.report("same-forces", *logs[:2]), "forces 7: bookworm g++/Debug, bookworm clang++/Debug, "
                         "trixie g++/Debug, trixie clang++/Debug\n")
        self.assertIn("forces 8: forky g++/Debug", self.report("same-forces", *logs, code=1))
        logs[0].write_text("FAILED  bookworm g++/Debug\n")
        self.assertIn("no build has passed", self.report("same-forces", *logs[:2], code=1))

    def test_lists_slowest(self):
        lines = self.report("slowest", self.folder).splitlines()
        self.assertEqual(lines[1].split(), ["300.0", "s", "build"])
        self.assertEqual(lines[lines.index("slowest tests:") + 1].split(), ["2.0", "s", "host:", "cli.link"])

    def test_missing_test_fails_gate(self):
        self.report("list", self.folder, self.list)
        self.assertIn("host Gate 2\nhost cli.link 1\n", self.list.read_text())
        said = self.report("gate", self.folder, self.list, code=1)  # for what was skipped
        self.assertIn("cli.link: test_key was skipped: no key", said)
        self.assertNotIn("did not pass", said)
        passed = re.sub(r'<testcase[^>]*status="notrun".*?</testcase>|^test_key.*?$', "", CASES, flags=re.S | re.M)
        (self.folder / "host.xml").write_text(passed)
        self.assertEqual(self.report("gate", self.folder, self.list), "")
        (self.folder / "host.xml").write_text(CASES.replace('name="Gate.Limits"', 'name="Other.Limits"'))
        said = self.report("gate", self.folder, self.list, code=1)
        self.assertIn("host Gate: 1 of the 2 tests did not pass", said)
        self.assertIn("1 tests are not on the list", said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
