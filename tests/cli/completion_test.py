"""Completion in a shell: bash completes commands, options and their values as the program has them.

usage: completion_test.py TACTREE
"""
import re
import subprocess
import sys
import unittest

TACTREE = sys.argv.pop(1)
# Calls the function as bash does for a line whose words are the arguments.
COMPLETE = """
source <("$1" completion bash) || exit 1
shift
COMP_WORDS=(tactree "$@")
COMP_CWORD=$#
_tactree
printf '%s\\n' "${COMPREPLY[@]}"
"""


class Completion(unittest.TestCase):
    def complete(self, *words):
        done = subprocess.run(["bash", "-euc", COMPLETE, "bash", TACTREE, *words], capture_output=True, text=True,
                              check=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    @staticmethod
    def help_of(*command):
        return subprocess.run([TACTREE, *command, "--help"], capture_output=True, text=True, check=True).stdout

    def test_commands(self):
        listed = re.findall(r"^  ([a-z]+)  ", self.help_of().split("Subcommands:")[1], re.M)
        self.assertGreater(len(listed), 20)
        self.assertEqual(self.complete(""), listed)
        self.assertEqual(self.complete("sim"), ["simulate"])
        self.assertEqual(self.complete("device", "to"), ["to-header"])

    def test_all_options_of_the_help(self):
        for command in ("build", "simulate", "serve"):
            rows = re.findall(r"^  (-[^\s{]+)", self.help_of(command), re.M)
            listed = {name for row in rows for name in row.split(",") if name.startswith("--")}
            self.assertGreater(len(listed), 5)
            self.assertEqual(set(self.complete(command, "--")), listed, command)

    def test_values(self):
        self.assertEqual(self.complete("simulate", "--mode", ""), ["surface", "paper"])
        self.assertEqual(self.complete("simulate", "m.blob", "--mode", "=", "p"), ["paper"])
        self.assertEqual(self.complete("simulate", "--mode", "="), ["surface", "paper"])
        self.assertIn("mm", self.complete("build", "a.ply", "--unit", ""))

    def test_names_of_files_are_left_to_bash(self):
        self.assertEqual(self.complete("build", ""), [])
        self.assertEqual(self.complete("build", "-o", ""), [])
        self.assertEqual(self.complete("simulate", "build", ""), [])

    def test_a_value_is_not_a_command(self):
        # A file called like a command does not change whose options follow.
        self.assertIn("--spacing", self.complete("build", "view", "--sp"))

    def test_other_shells_are_refused(self):
        done = subprocess.run([TACTREE, "completion", "fish"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("'fish' is not bash", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
