"""Scans and blobs from standard input, and formats that are named instead of recognised.

usage: stdin_test.py TACTREE
"""
import os
import pathlib
import resource
import struct
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, sphere, write_3mf  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


class Folder(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.spool = cls.path / "spool"
        cls.spool.mkdir()
        cls.scan = sphere(1500, 0.05).encode()
        (cls.path / "s.xyz").write_bytes(cls.scan)
        cls.run_tool("build", "s.xyz", "-o", "s.blob")
        cls.blob = (cls.path / "s.blob").read_bytes()

    @classmethod
    def run_tool(cls, *arguments, stdin=b"", **options):
        done = super().run_tool(*arguments, text=False, input=stdin,
                                env={**os.environ, "TMPDIR": str(cls.spool)}, **options)
        done.stdout, done.stderr = done.stdout.decode(), done.stderr.decode()
        return done

    def build(self, stdin, *arguments):
        done = self.run_tool("build", "-", "-o", "y.blob", "--report", "r.json", *arguments,
                             stdin=stdin)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(os.listdir(self.spool), [])
        return self.read("r.json")

    def refused(self, stdin, *arguments, **options):
        done = self.run_tool(*arguments, stdin=stdin, **options)
        self.assertIn(done.returncode, (1, 2), done.stdout)
        self.assertEqual(os.listdir(self.spool), [])
        return done.stderr


class Scans(Folder):
    def test_pipe_and_file_give_same_blob(self):
        report = self.build(self.scan, "--name", "s")
        self.assertEqual(report["inputs"], [{"file": "standard input", "format": "text, separated by spaces",
                                             "points": 1500, "triangles": 0}])
        self.assertEqual((self.path / "y.blob").read_bytes(), self.blob)
        self.build(self.scan)
        self.assertIn("model         stdin ", self.run_tool("info", "y.blob").stdout)

    def test_recognises_binary_and_packed_formats(self):
        points = [tuple(map(float, line.split())) for line in self.scan.decode().splitlines()]
        head = ("ply\nformat binary_little_endian 1.0\nelement vertex 1500\nproperty float x\n"
                "property float y\nproperty float z\nend_header\n")
        body = b"".join(struct.pack("<3f", *p) for p in points)
        self.assertEqual(self.build(head.encode() + body)["inputs"][0]["points"], 1500)
        write_3mf(self.path / "a.3mf", unit="centimeter")
        report = self.build((self.path / "a.3mf").read_bytes(), "--spacing", "0.005")
        self.assertEqual(report["inputs"][0]["triangles"], 12)
        self.assertAlmostEqual(report["source_scale"], 0.01)

    def test_messages_name_standard_input(self):
        for scan in (b"", b"ply\nformat nonsense 1.0\n", b"PK\3\4 3D/ [Content_Types].xml",
                     b'{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":9}],'
                     b'"meshes":[]}', b"ASTM-E57" + bytes(4000)):
            message = self.refused(scan, "build", "-", "-o", "no.blob")
            self.assertIn("standard input", message)
            self.assertNotIn("/proc", message)
            self.assertNotIn(str(self.spool), message)
        self.assertFalse((self.path / "no.blob").exists())

    def test_reads_standard_input_once(self):
        self.assertIn("given only once", self.refused(b"", "build", "-", "-", "-o", "no.blob"))
        done = self.run_tool("build", "s.xyz", "-", "-o", "y.blob", stdin=b"0 0 0.2\n" * 3)
        self.assertIn("read      standard input: text, separated by spaces, 3 points", done.stdout)

    def test_names_full_folder(self):
        message = self.refused(self.scan, "build", "-", "-o", "no.blob", preexec_fn=small_files)
        self.assertIn(f"it cannot be stored in {self.spool}: File too large (set TMPDIR", message)


class Formats(Folder):
    def test_unrecognised_format_names_option(self):
        message = self.refused(bytes(range(1, 200)), "build", "-", "-o", "no.blob")
        self.assertIn("name its format with --format", message)

    def test_uses_named_format_if_ambiguous(self):
        for name in ("xyz", "XYZ", "csv"):
            self.assertEqual(self.build(self.scan, "--format", name)["inputs"][0]["points"], 1500)
        # 80 bytes that begin like a picture, and one triangle fewer than the header says.
        triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
        stl = b"GIF8".ljust(80, b" ") + struct.pack("<I", 0) + 4 * triangle
        self.assertIn("GIF picture", self.refused(stl, "build", "-", "-o", "no.blob"))
        self.assertEqual(self.build(stl, "--format", "stl")["inputs"][0]["triangles"], 4)

    def test_refuses_contradicted_format_name(self):
        ply = b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"
        for name, shown in (("stl", "STL"), ("obj", "OBJ"), ("dae", "COLLADA")):
            message = self.refused(ply, "build", "-", "-o", "no.blob", "--format", name)
            self.assertIn(f"this is PLY by its content, not {shown} (omit --format)", message)
        message = self.refused(self.scan, "build", "-", "-o", "no.blob", "--format", "ply")
        self.assertIn("standard input", message)
        self.assertIn("--format", self.refused(b"", "build", "-", "-o", "y", "--format", "doc"))


class Blobs(Folder):
    def test_reads_blob_from_standard_input(self):
        (self.path / "p.csv").write_text("0,0,0.05\n")
        for verb in (("info",), ("check",), ("query", "--points", "p.csv")):
            piped = self.run_tool(verb[0], "-", *verb[1:], stdin=self.blob)
            named = self.run_tool(verb[0], "s.blob", *verb[1:])
            self.assertEqual(piped.returncode, 0, piped.stderr)
            self.assertEqual(piped.stdout.replace("-: valid", "s.blob: valid"), named.stdout)

    def test_refuses_other_bytes(self):
        for bytes_, cause in ((self.blob[:-4], f"the file has {len(self.blob) - 4}"),
                              (self.blob + b"x", f"has {len(self.blob)} and more"),
                              (b"", "shorter than"), (self.scan, "not a Tactree blob")):
            message = self.refused(bytes_, "check", "-")
            self.assertIn("standard input: refused: ", message)
            self.assertIn(cause, message)
        self.assertIn("is already used for the blob", self.refused(self.blob, "query", "-", "--points", "-"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
