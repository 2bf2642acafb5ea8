"""`tactree build` and the commands that read a blob, at the limits of files, numbers and formats.

usage: build_test.py TACTREE
"""
import json
import os
import pathlib
import resource
import signal
import shutil
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import CORNERS, FACES, ToolFolder, sphere, write_3mf  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it


class Folder(ToolFolder):
    tool = TACTREE

    def refused(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertIn(done.returncode, (1, 2), done.stdout)
        return done.stderr


class Columns(Folder):
    def test_report_states_columns(self):
        rows = (self.path / "s.xyz").read_text().splitlines()
        numbered = "".join(f"{1000 + i},{row.replace(' ', ',')}\n" for i, row in enumerate(rows))
        self.write("n.csv", numbered)
        done = self.run_tool("build", "n.csv", "-o", "n.blob", "--report", "n.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        note = [line for line in done.stdout.splitlines() if "columns" in line]
        self.assertEqual(len(note), 1, done.stdout)
        self.assertIn("n.csv: columns x=2, y=3, z=4", note[0])
        self.assertIn("column 1 numbers the points", note[0])
        report = self.read("n.json")
        self.assertIn("columns x=2, y=3, z=4", "".join(report["notes"]))

    def test_measures_steps(self):
        (self.path / "steps.xyz").write_text("".join(f"{x} {y} {x * y / 50}\n" for x in range(50) for y in range(50)))
        done = self.run_tool("build", "steps.xyz", "-o", "y", "--report", "r.json", "--verbose")
        self.assertEqual(done.returncode, 0, done.stderr)
        stages = self.read("r.json")["stages"]
        self.assertEqual([stage["name"] for stage in stages][:2], ["reading steps.xyz", "cleaning"])
        for stage in stages:
            self.assertEqual(set(stage), {"name", "seconds", "cpu_seconds", "points", "peak_rss_bytes"})
            self.assertIn(f"s  {stage['name']}: {stage['points']} points, peak", done.stdout)

    def test_uses_named_columns(self):
        rows = (self.path / "s.xyz").read_text().splitlines()
        swapped = "".join(" ".join(["a", *reversed(row.split())]) + "\n" for row in rows)
        self.write("t.txt", swapped)
        self.assertIn("--columns x=2,y=3,z=4", self.refused("build", "t.txt", "-o", "t.blob"))
        done = self.run_tool("build", "t.txt", "-o", "t.blob", "--columns", "x=4,y=3,z=2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.build("--name", "t")
        points = []
        for blob in ("s.blob", "t.blob"):
            self.run_tool("info", blob, "--points", "p.csv")
            points.append((self.path / "p.csv").read_text())
        self.assertEqual(points[0], points[1])

    def test_misuse_names_option(self):
        for columns in ("x=2,y=3", "x=0,y=1,z=2", "x=1,y=1,z=2", "q=1,y=2,z=3"):
            done = self.run_tool("build", "s.xyz", "-o", "y", "--columns", columns)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("--columns", done.stderr)
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        done = self.run_tool("build", "m.obj", "-o", "y", "--columns", "x=1,y=2,z=3")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("m.obj", done.stderr)


class Turn(Folder):
    def middle(self, *options):
        """Of a ball whose middle is at z = 0.1 in the file."""
        rows = [row.split() for row in sphere(2000, 0.05).splitlines()]
        self.write("s.xyz", "".join(f"{x} {y} {float(z) + 0.1}\n" for x, y, z in rows))
        done = self.run_tool("build", "s.xyz", "-o", "t.blob", "--unit", "m", "--report", "r.json", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        report = self.read("r.json")
        return [round((low + high) / 2, 2) + 0.0
                for low, high in zip(report["bounds_min_m"], report["bounds_max_m"])]

    def test_turns_about_vertical_after_axis(self):
        self.assertEqual(self.middle("--turn", "90"), [0, 0, 0.1])
        self.assertEqual(self.middle("--axis", "y"), [0.1, 0, 0])
        self.assertEqual(self.middle("--axis", "y", "--turn", "90"), [0, 0.1, 0])
        self.assertEqual(self.middle("--axis", "y", "--turn", "-30"), [0.09, -0.05, 0])
        report = self.read("r.json")
        self.assertEqual((report["axis"], report["turn_deg"]), ("y", -30))

    def test_refuses_invalid_angles(self):
        for angle in ("x", "nan", "inf", "361"):
            done = self.run_tool("build", "s.xyz", "-o", "y", "--turn", angle)
            self.assertEqual(done.returncode, 2, angle)
            self.assertIn("--turn", done.stderr)


class Outputs(Folder):
    def test_never_overwrites_input(self):
        self.build()
        blob = (self.path / "s.blob").read_bytes()
        (self.path / "link").symlink_to("s.blob")
        for output in ("--json", "--points", "--preview"):
            for name in ("s.blob", "./s.blob", "link"):
                self.assertIn("is an input", self.refused("info", "s.blob", output, name))
        self.assertIn("is an input", self.refused("check", "s.blob", "--json", "s.blob"))
        self.assertIn("is an input", self.refused("query", "s.blob", "--points", "s.xyz",
                                                  "--json", "s.blob"))
        self.assertIn("is an input", self.refused("simulate", "s.blob", "--trace", "s.blob"))
        self.assertEqual((self.path / "s.blob").read_bytes(), blob)

    def test_guards_every_input(self):
        self.build()
        self.run_tool("keygen", "k")
        self.run_tool("sign", "s.blob", "--key", "k")
        self.write("m.json", '{"stiffness_N_m": 500}')
        self.write("d.json", self.run_tool("simulate", "--dump-device").stdout)
        self.write("pose.json", '{"pose": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}')
        self.write("scene.json", '{"bodies": [{"blob": "s.blob", "pose": "pose.json"}]}')
        (self.path / "scans").mkdir()
        shutil.copy(self.path / "s.xyz", self.path / "scans" / "t.xyz")
        before = {file: file.read_bytes() for file in self.path.rglob("*") if file.is_file()}
        for command in ("check s.blob --key k.pub --json k.pub", "check s.blob --json s.blob.sig",
                        "evaluate --scan s.xyz --report s.xyz", "build s.xyz -o b --material m.json --report m.json",
                        "build s.xyz -o b --fit device:d.json --report d.json",
                        "build s.xyz -o m.json --board netduinoplus2 --rate 1000 --device m.json",
                        "build --collection scans -o out --json scans/t.xyz", "info s.blob --device d.json --json d.json",
                        "simulate s.blob --device d.json --json d.json", "simulate --scene scene.json --json pose.json",
                        "simulate --scene scene.json --trace s.blob"):
            self.assertIn("is an input", self.refused(*command.split()), command)
        self.assertEqual({file: file.read_bytes() for file in before}, before)
        self.assertIn("two outputs", self.refused("evaluate", "--scan", "s.xyz", "--json", "e", "--report", "e"))

    def test_writes_blob_to_standard_output(self):
        self.build()
        for name in ("-", "/dev/stdout"):
            done = self.run_tool("build", "s.xyz", "-o", name, text=False)
            self.assertEqual(done.stdout, (self.path / "s.blob").read_bytes())
            self.assertIn(b"model ", done.stderr)
        self.assertFalse((self.path / "-").exists())

    def test_refuses_same_file_for_outputs(self):
        for output in ("--report", "--json", "--preview"):
            message = self.refused("build", "s.xyz", "-o", "y", output, "./y")
            self.assertIn("two outputs", message)
        self.assertFalse((self.path / "y").exists())
        self.build("--report", "/dev/null", "--json", "/dev/null")

    def test_checks_outputs_before_reading(self):
        (self.path / "folder").mkdir()
        for name in ("no/such/y", "s.xyz/y", "folder"):
            message = self.refused("build", "no_input", "-o", "y", "--report", name)
            self.assertIn(f"{name}: cannot be written", message)
        self.assertIn("'' is not the name", self.refused("build", "s.xyz", "-o", ""))

    def test_reports_unwritable_standard_output(self):
        self.build()
        self.write("many.xyz", sphere(20000, 0.05))
        with open("/dev/full", "w", encoding="ascii") as full:
            done = self.run_tool("query", "s.blob", "--points", "many.xyz", capture_output=False,
                                 stdout=full, stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 1)
        self.assertIn("standard output cannot be written", done.stderr)

    def test_file_limit_leaves_no_temporary(self):
        done = self.run_tool("build", "s.xyz", "-o", "s.blob", preexec_fn=small_files)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("File too large", done.stderr)
        self.assertEqual(os.listdir(self.path), ["s.xyz"])


class Tables(Folder):
    def test_query_uses_names_of_columns(self):
        self.build()
        rows = "".join(f"{z},{y},{x},7\n" for x, y, z in ((0.06, 0, 0), (0, 0.055, 0), (0, 0, 0.04)))
        self.write("plain.csv", "0.06,0,0\n0,0.055,0\n0,0,0.04\n")
        plain = self.run_tool("query", "s.blob", "--points", "plain.csv")
        self.assertEqual(plain.returncode, 0, plain.stderr)
        for names in ("z,y,x,t\n", "z_m,y_m,x_m,t\n"):
            self.write("named.csv", names + rows)
            self.assertEqual(self.run_tool("query", "s.blob", "--points", "named.csv").stdout, plain.stdout)
        self.write("other.csv", "t_s,px,py,pz\n0,0,0,0.06\n")
        self.assertIn("other.csv: line 1: no column is named x (name them, or omit the line",
                      self.refused("query", "s.blob", "--points", "other.csv"))

    def test_query_refuses_numbers_beyond_float(self):
        self.build()
        self.write("far.csv", "1e39,0,0\n")
        self.assertIn("far.csv: line 1: a coordinate is not a float32 number",
                      self.refused("query", "s.blob", "--points", "far.csv"))

    def test_refuses_values_that_would_be_lost(self):
        self.assertIn("stiffness is given twice",
                      self.refused("build", "s.xyz", "-o", "b", "--material", "stiffness=100,stiffness=200"))
        done = self.run_tool("build", "s.xyz", "-o", "b", "--name", "n" * 32)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--name: is longer than 31 bytes", done.stderr)

    def test_path_refuses_other_columns(self):
        self.build()
        for names, missing in (("t_ms,x,y,z", "t_s"), ("t_s,x_mm,y_mm,z_mm", "x")):
            self.write("path.csv", names + "\n0,0,0,0.1\n1,0,0,0.04\n")
            self.assertIn(f"path.csv: line 1: no column is named {missing} (",
                          self.refused("simulate", "s.blob", "--path", "path.csv"))

    def test_refuses_faults_without_effect(self):
        self.build()
        for fault, cause in (("encoder2:stuck@0.5", "'hapkit' has 1 axis"), ("motor3:reversed@0", "has 1 axis"),
                             ("encoder1:stuck@5", "begins after the end of the run, which takes 1 s")):
            self.assertIn(f"--inject {fault}: {cause}" if "hapkit" in cause or "begins" in cause else cause,
                          self.refused("simulate", "s.blob", "--device", "hapkit", "--seconds", "1", "--inject", fault))


class Numbers(Folder):
    def test_refuses_absurd_sizes_with_cause(self):
        for option in ("--scale", "--fit"):
            for value in ("1e300", "1e30", "1e-30", "1e-300"):
                message = self.refused("build", "s.xyz", "-o", "y", option, value)
                self.assertIn("--scale", message, value)
                self.assertNotIn("own check", message)
        for spacing in ("1e300", "1e-300"):
            message = self.refused("build", "s.xyz", "-o", "y", "--spacing", spacing)
            self.assertIn("outside 1 nm .. 1000 km", message)

    def test_drops_excessive_coordinates(self):
        with open(self.path / "s.xyz", "a", encoding="ascii") as file:
            file.write("1e300 0 0\n0 -1e150 0\n")
        self.build("--report", "r.json")
        report = self.read("r.json")
        self.assertEqual(report["dropped"], {"out_of_range": 2})
        self.write("huge.xyz", sphere(500, 1e300))
        self.assertIn("500 out_of_range", self.refused("build", "huge.xyz", "-o", "y"))

    def test_refuses_empty_numbers(self):
        self.assertIn("'' is not a number", self.refused("build", "s.xyz", "-o", "y", "--spacing", ""))
        self.assertIn("'' is not a number",
                      self.refused("build", "s.xyz", "-o", "y", "--flash-budget", ""))

    def test_prints_lengths_without_exponent(self):
        self.assertRegex(self.build("--scale", "1e7").stdout, r"spacing \d+\.?\d* km\n")
        self.assertRegex(self.build("--scale", "1e-4").stdout, r"spacing \d+\.?\d* um\n")


class Formats(Folder):
    def test_refuses_damaged_header_before_body(self):
        with open(self.path / "large.ply", "wb") as file:
            file.write(b"ply\nformat nonsense 1.0\n")
            file.truncate(1 << 38)  # takes no space, and minutes to read
        self.assertIn("nonsense", self.refused("build", "large.ply", "-o", "y"))

    def write_ply(self, line):
        lines = sphere(500, 0.05).splitlines()
        head = ["ply", "format ascii 1.0", line, f"element vertex {len(lines)}",
                "property float x", "property float y", "property float z", "end_header"]
        self.write("a.ply", "\n".join(head + lines) + "\n")

    def test_warns_of_unknown_ply_header_lines(self):
        self.write_ply("scanner_serial 1234 rev B")
        done = self.run_tool("build", "a.ply", "-o", "y")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('1 line of the header is unknown and left out, the first at line 3, '
                      '"scanner_serial"', done.stderr)

    def test_refuses_misspelt_ply_keywords(self):
        for line in ("proprty float x", "elemnt vertex 9", "Format binary_little_endian 1.0"):
            self.write_ply(line)
            self.assertIn("is not a keyword of a PLY header",
                          self.refused("build", "a.ply", "-o", "y"))

    def test_reads_unusual_3mf_archives(self):
        write_3mf(self.path / "a.3mf", "3D/part of mine.model")
        write_3mf(self.path / "b.3mf", "3D/3dmodel.model", "Metadata/thumbnail.png")
        for name in ("a.3mf", "b.3mf"):
            done = self.run_tool("build", name, "-o", "y", "--fit", "0.1", "--spacing", "0.005")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("3MF, 8 points, 12 triangles", done.stdout)

    def test_option_overrides_3mf_unit(self):
        for unit, options, metres in (("inch", (), 0.0254), ("millimeter", (), 0.001),
                                      ("inch", ("--unit", "cm"), 0.01)):
            write_3mf(self.path / "a.3mf", "3D/3dmodel.model", unit=unit)
            done = self.run_tool("build", "a.3mf", "-o", "y", "--report", "r.json", *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = self.read("r.json")
            self.assertAlmostEqual(report["source_scale"], metres)
            self.assertEqual("unit of the file" in done.stdout, not options)

    def test_uses_fbx_unit(self):
        points = ",".join("%g,%g,%g" % corner for corner in CORNERS)
        faces = ",".join("%d,%d,%d" % (a, b, -c - 1) for a, b, c in FACES)
        (self.path / "a.fbx").write_text(f"""; FBX 7.3.0 project file
FBXHeaderExtension:  {{
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UnitScaleFactor", "double", "Number", "",2.54
	}}
}}
Objects:  {{
	Geometry: 1, "Geometry::", "Mesh" {{
		Vertices: *24 {{
			a: {points}
		}}
		PolygonVertexIndex: *36 {{
			a: {faces}
		}}
	}}
	Model: 2, "Model::box", "Mesh" {{
		Version: 232
	}}
}}
Connections:  {{
	C: "OO",2,0
	C: "OO",1,2
}}
""")
        done = self.run_tool("build", "a.fbx", "-o", "y", "--report", "r.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertAlmostEqual(self.read("r.json")["source_scale"],
                               0.0254)

    def test_refusal_names_gltf_compression(self):
        buffer = {"byteLength": 99, "extensions": {"KHR_meshopt_compression": {"fallback": True}}}
        (self.path / "a.gltf").write_text(json.dumps(
            {"asset": {"version": "2.0"}, "buffers": [buffer],
             "extensionsRequired": ["KHR_meshopt_compression"]}))
        message = self.refused("build", "a.gltf", "-o", "y")
        self.assertIn("compressed with KHR_meshopt_compression", message)
        self.assertNotIn("uri", message)

    def test_refuses_damaged_collada_briefly(self):
        (self.path / "a.dae").write_text(
            '<?xml version="1.0"?><COLLADA version="1.4.1"><library_geometries><geometry id="g">'
            f'<mesh><source id="p"><float_array id="a" count="3000">{"no number " * 3000}'
            "</float_array></source></mesh></geometry></library_geometries></COLLADA>")
        message = self.refused("build", "a.dae", "-o", "y")
        self.assertIn("this COLLADA cannot be read: Cannot parse", message)
        self.assertLess(len(message), 400)


if __name__ == "__main__":
    unittest.main(verbosity=2)
