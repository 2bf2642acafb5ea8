"""Errors in the command line: unknown commands, and values out of range; what the help says of ports.

usage: usage_test.py TACTREE
"""
import subprocess
import sys
import tempfile
import unittest

TACTREE = sys.argv.pop(1)


class Usage(unittest.TestCase):
    def refused(self, *arguments):
        done = subprocess.run([TACTREE, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertLess(max(map(len, done.stderr.splitlines())), 120, done.stderr)
        return done.stderr

    def test_unknown_command_names_nearest(self):
        self.assertIn("unknown command 'biuld' (did you mean 'build'? tactree --help lists the commands)",
                      self.refused("biuld", "x.ply"))
        error = self.refused("frobnicate")
        self.assertIn("unknown command 'frobnicate' (tactree --help", error)

    def test_unknown_command_below_a_command(self):
        self.assertIn("unknown command 'chek' (did you mean 'check'? tactree device --help lists the commands)",
                      self.refused("device", "chek"))
        self.assertIn("a command is required (tactree device --help", self.refused("device"))

    def test_unknown_option_names_nearest(self):
        self.assertIn("there is no option '--spacng' (did you mean '--spacing'? tactree build --help lists the options)",
                      self.refused("build", "x.ply", "-o", "y", "--spacng=1"))
        self.assertIn("there is no option '--frobnicate' (tactree info", self.refused("info", "x", "--frobnicate"))
        self.assertIn("the argument 'y' is not expected", self.refused("info", "x", "y"))

    def test_names_what_is_missing(self):
        self.assertIn("error: --output is required (tactree build --help", self.refused("build", "x.ply"))
        self.assertIn("--output: a value is required", self.refused("build", "x.ply", "-o"))
        self.assertIn("--crop: 6 values are required", self.refused("build", "x.ply", "-o", "y", "--crop", "1,2,3"))

    def fails(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([TACTREE, *arguments], cwd=folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, (arguments, done.stderr))
        return done.stderr

    def test_missing_file_has_one_exit_code(self):
        for arguments in (("build", "nope", "-o", "y"), ("build", "x", "-o", "y", "--pose", "nope"), ("info", "nope"),
                          ("build", "x", "-o", "y", "--for", "nope"), ("check", "x", "--key", "nope"),
                          ("simulate", "x", "--replay", "nope"), ("simulate", "x", "--scene", "nope"),
                          ("evaluate", "--scan", "nope"), ("bound", "nope"), ("device", "check", "nope")):
            self.assertIn("nope", self.fails(*arguments))
        self.assertIn("/: is a folder", self.fails("simulate", "x", "--replay", "/"))

    def test_quotes_numbers_out_of_range(self):
        for value in ("-1", "0", "nan", "inf", "ten", "1e999"):
            error = self.refused("simulate", "model.blob", f"--seconds={value}")
            self.assertIn(f"'{value}' is not a number above 0", error)
        self.assertIn("--rate: '50' is not from 100 to 20000 (", self.refused("simulate", "model.blob", "--rate=50"))
        self.assertIn("'-1' is not a number from 0 upwards",
                      self.refused("query", "model.blob", "--points", "-", "--radius=-1"))

    def test_quotes_unknown_names(self):
        for option, expected in (("--axis", "x, y or z"), ("--unit", "m, cm, mm, um, in or ft"),
                                 ("--profile", "surface or paper"), ("--progress", "auto, plain, json or off"),
                                 ("--orient", "auto, outward, viewpoint, up or given")):
            error = self.refused("build", "two.ply", "-o", "x.blob", option, "w")
            self.assertIn(f"{option}: 'w' is not {expected} (tactree build --help", error)
            self.assertNotIn("\0", error)

    def test_help_lists_names(self):
        text = " ".join(self.help_of("build").split())
        for option, names in (("--axis", "x|y|z"), ("--orient", "auto|outward|viewpoint|up|given"),
                              ("--progress", "auto|plain|json|off")):
            self.assertIn(f"{option} {names}", text.replace(" TEXT:", " ").replace(" ENUM:", " "))

    def test_quotes_what_is_no_number(self):
        for verb, value, error in (
                (("build", "two.ply", "-o", "x"), "--turn=abc", "--turn: 'abc' is not a number ("),
                (("build", "two.ply", "-o", "x"), "--min-piece=1.5", "--min-piece: '1.5' is not a whole number ("),
                (("build", "two.ply", "-o", "x"), "--crop=1,2,x,4,5,6", "--crop: '1,2,x,4,5,6' is not a number ("),
                (("evaluate",), "--seed=x", "--seed: 'x' is not a whole number (")):
            self.assertIn(error, self.refused(*verb, value))

    def test_refuses_numbers_that_would_wrap(self):
        self.assertIn("'-1' is not a whole number from 0 upwards", self.refused("build", "x.ply", "-o", "x", "--min-piece=-1"))
        self.assertIn("4294967296 is too large", self.refused("sign", "x.blob", "--key", TACTREE, "--counter", "4294967296"))

    def test_refuses_numbers_that_are_not_finite(self):
        for verb in (("bound", "x.elf"), ("build", "x.ply", "-o", "x"), ("simulate", "x.blob")):
            for value in ("nan", "inf", "0"):
                self.assertIn("--rate", self.refused(*verb, f"--rate={value}"))

    def test_flash_does_one_thing(self):
        for others in (("x.blob", "--list"), ("--list", "--roll-back"), ("--list", "--erase", "0"),
                       ("--erase", "0", "--roll-back")):
            self.assertIn("excludes", self.refused("flash", "--port", "unix:/nowhere", *others))

    def test_refuses_options_without_effect(self):
        for options in (("--trace", "t.csv"), ("--plot", "p.svg"), ("--inject", "loop:overrun=2@1s")):
            self.assertIn("--replay excludes", self.refused("simulate", "x.blob", "--replay", TACTREE, *options)
                          .replace(f"{options[0]} excludes --replay", "--replay excludes"))
        self.assertIn("excludes", self.refused("simulate", "--dump-device", "--device-mass", "1"))

    def test_refuses_extensions_of_other_formats(self):
        for verb, option, file, written in (("simulate", "--trace", "x.npz", ".csv"), ("simulate", "--plot", "x.png", ".svg"),
                                            ("build", "--preview", "x.jpg", ".png"), ("info", "--preview", "x.svg", ".png")):
            self.assertIn(f"'{file}' is written as {written}", self.refused(verb, "x", option, file))

    def test_help_names_all_port_kinds(self):
        ports = "a serial port, usb:SERIAL, unix:PATH (of tactree-controller or tactree serve), or the one that tactree "\
            "simulate --serve prints (with --lock-step: step:PATH)"
        for verb in ("devices", "flash", "monitor", "arm", "stop", "trace", "params", "record", "serve", "view"):
            self.assertIn(ports, " ".join(self.help_of(verb).split()), verb)
        self.assertIn("--serve: use a port step:PATH", " ".join(self.help_of("simulate").split()))

    def help_of(self, verb):
        return subprocess.run([TACTREE, verb, "--help"], capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    unittest.main(verbosity=2)
