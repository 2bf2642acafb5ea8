"""Materials end to end: a coloured scan -> build --material -> info -> simulate.

usage: materials_test.py TACTREE
"""
import json
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
RED, BLUE = (250, 10, 5), (20, 30, 240)
FORMATS = ("ply", "obj", "pcd", "off", "csv")


def points():
    """A sheet of 6 cm: red where x > 0, blue elsewhere."""
    return [(i * 5e-4, j * 5e-4, 0.0, RED if i > 0 else BLUE)
            for i in range(-60, 61) for j in range(-60, 61)]


def scan(suffix):
    rows = points()
    if suffix == "ply":
        head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}"]
        head += [f"property float {name}" for name in "xyz"]
        head += [f"property uchar {name}" for name in ("red", "green", "blue")] + ["end_header"]
        body = [f"{x} {y} {z} {c[0]} {c[1]} {c[2]}" for x, y, z, c in rows]
    elif suffix == "obj":
        head = []
        body = [f"v {x} {y} {z} {c[0] / 255} {c[1] / 255} {c[2] / 255}" for x, y, z, c in rows]
    elif suffix == "pcd":
        head = ["VERSION 0.7", "FIELDS x y z rgb", "SIZE 4 4 4 4", "TYPE F F F U", "COUNT 1 1 1 1",
                f"WIDTH {len(rows)}", "HEIGHT 1", f"POINTS {len(rows)}", "DATA ascii"]
        body = [f"{x} {y} {z} {c[0] << 16 | c[1] << 8 | c[2]}" for x, y, z, c in rows]
    elif suffix == "off":
        head = ["COFF", f"{len(rows)} 0 0"]
        body = [f"{x} {y} {z} {c[0]} {c[1]} {c[2]} 255" for x, y, z, c in rows]
    else:
        head = ["x,y,z,red,green,blue"]
        body = [f"{x},{y},{z},{c[0]},{c[1]},{c[2]}" for x, y, z, c in rows]
    return "\n".join(head + body) + "\n"


class Materials(SharedFolder):
    tool = TACTREE

    def ok(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def build(self, material, suffix="ply", blob="model.blob"):
        self.write("scan." + suffix, scan(suffix))
        self.ok("build", "scan." + suffix, "--material", material, "-o", blob, "--progress", "off",
                "--report", "report.json")
        self.ok("info", blob, "--json", "info.json")
        return self.read("info.json")

    def two_colours(self):
        return self.write("map.json", {
            "default": {"stiffness_N_m": 800, "damping_Ns_m": 0.5},
            "colours": [{"name": "felt", "rgb": [255, 0, 0], "tolerance": 30,
                         "stiffness_N_m": 200, "static_friction": 0.2}]})

    def test_colours_of_all_formats_become_materials(self):
        for suffix in FORMATS:
            with self.subTest(suffix):
                info = self.build(self.two_colours(), suffix)
                self.assertEqual(info["materials"], 2)
                base, felt = info["material_list"]
                self.assertEqual((base["stiffness_N_m"], felt["stiffness_N_m"]), (800, 200))
                self.assertEqual((base["damping_Ns_m"], felt["damping_Ns_m"]), (0.5, 0.5))
                self.assertEqual((base["static_friction"], felt["static_friction"]), (0, 0.2))
                self.assertEqual(base["points"] + felt["points"], info["points"])
                self.assertAlmostEqual(felt["points"] / info["points"], 60 / 121, delta=0.02)
                report = self.read("report.json")
                self.assertEqual([(m["name"], m["points"]) for m in report["materials"]],
                                 [("default", base["points"]), ("felt", felt["points"])])

    def test_info_names_materials_of_file(self):
        self.build(self.two_colours())
        text = self.ok("info", "model.blob", "--material", "map.json", "--json", "named.json")
        self.assertRegex(text, r"material 0 +default, all other colours: \d+ points: 800 N/m")
        self.assertRegex(text, r"material 1 +felt, colours within 30 of \[255, 0, 0\]: \d+ points: 200 N/m")
        base, felt = self.read("named.json")["material_list"]
        self.assertEqual((base["name"], felt["name"], felt["rgb"]), ("default", "felt", [255, 0, 0]))
        self.assertIn("--material FILE", self.ok("info", "model.blob"))

    def test_info_refuses_foreign_materials(self):
        self.build(self.two_colours())
        other = json.loads((self.path / "map.json").read_text())
        other["colours"][0]["static_friction"] = 0.3
        for name, content, cause in (("values.json", other, "the material 'felt' has other values than material 1"),
                                     ("one.json", {"stiffness_N_m": 800}, "describes 1 materials, model.blob has 2")):
            done = self.run_tool("info", "model.blob", "--material", self.write(name, content))
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{name}: {cause}", done.stderr)
            self.assertIn("(give the file with which the model was built)", done.stderr)

    def warning_of(self, *colours):
        self.write("scan.ply", scan("ply"))
        self.write("map.json", {"default": {"stiffness_N_m": 800},
                                "colours": [{"name": name, "rgb": rgb, "tolerance": tolerance}
                                            for name, rgb, tolerance in colours]})
        done = self.run_tool("build", "scan.ply", "--material", "map.json", "-o", "model.blob", "--progress", "off",
                             "--report", "report.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def test_unused_colour_lists_existing_colours(self):
        error = self.warning_of(("green", [20, 200, 40], 30), ("red", RED, 30))
        self.assertIn("the material 'green': the nearest to [20, 200, 40] is [20, 30, 240], at a distance of 263", error)
        self.assertIn("the scan has [20, 30, 240] 7381 points, [250, 10, 5] 7260 points)", error)
        self.assertEqual(error.count("no point has"), 1)
        report = self.read("report.json")
        self.assertEqual(report["colours"], [{"rgb": list(BLUE), "points": 7381}, {"rgb": list(RED), "points": 7260}])
        self.assertEqual(report["materials"][1]["rgb"], [20, 200, 40])

    def test_states_missing_tolerance(self):
        self.assertIn("at a distance of 11 (raise its tolerance of 10", self.warning_of(("red", [240, 10, 1], 10)))
        self.assertNotIn("no point", self.warning_of(("red", [240, 10, 1], 11)))

    def test_ignores_points_of_nearer_colours(self):
        error = self.warning_of(("red", RED, 30), ("almost red", [240, 10, 1], 30))
        self.assertIn("'almost red': the points within 30 of its colour are nearer to that of another", error)
        self.assertNotIn("raise its tolerance", error)

    def force_at(self, x, *options):
        """Held 2 mm below the surface by a spring of 300 N/m."""
        self.write("path.csv", f"t_s,x,y,z\n0,{x},0,0.005\n0.2,{x},0,-0.002\n1,{x},0,-0.002\n")
        self.ok("simulate", "model.blob", "--path", "path.csv", "--seconds", "1", "--device",
                "cartesian", "--device-friction", "0", "--json", "run.json", *options)
        return self.read("run.json")

    def test_sides_differ_in_stiffness(self):
        self.build(self.two_colours())
        for x, stiffness in ((-0.015, 800), (0.015, 200)):
            depth = self.force_at(x)["penetration_max_m"]
            self.assertGreater(depth, 0.002 * 300 / (300 + stiffness) * 0.95)
            self.assertLess(depth, 0.002 * 300 / (300 + stiffness) * 1.5)
        soft = self.force_at(-0.015, "--no-materials", "--stiffness", "100")
        self.assertGreater(soft["penetration_max_m"], 0.00142)

    def test_accepts_single_material(self):
        for option in (self.write("one.json", {"stiffness_N_m": 321}), "stiffness=321"):
            info = self.build(option)
            self.assertEqual([m["stiffness_N_m"] for m in info["material_list"]], [321])

    def test_refuses_stiffness_above_device_limit(self):
        self.build("stiffness=20000")
        done = self.run_tool("simulate", "model.blob", "--seconds", "1")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"material 0.*20000 N/m.*limit of \d+.* N/m.*1000 Hz")
        self.ok("simulate", "model.blob", "--seconds", "1", "--no-materials")

    def test_refuses_invalid_files_with_hint(self):
        self.write("scan.ply", scan("ply"))
        cases = [
            ('{"stiffness_N_m": 1e9}', "stiffness_N_m: 1e+09 is outside"),
            ('{"stiffness_N_m": -1}', "stiffness_N_m: -1 is outside"),
            ('{"stiffness_N_m": NaN}', "is not JSON"),
            ('{"stiffness_N_m": "500"}', "is not a number"),
            ('{"stiffness": 500}', "material.stiffness: is not a property"),
            ('{"damping_Ns_m": 1}', "stiffness_N_m is missing"),
            ('{"stiffness_N_m": 5, "dynamic_friction": 0.3}', "dynamic_friction: 0.3 is more"),
            ('{"stiffness_N_m": 5, "texture_height_m": 1e-3}', "texture_height_m: 0.001 is more"),
            ('[1]', "is not an object"),
            ('{"colours": []}', '"default" is missing'),
            ('{"default": {"stiffness_N_m": 5}, "colors": []}', "colors: is neither"),
            ('{"default": {"stiffness_N_m": 5}, "colours": [{"rgb": [1, 2]}]}', "colours[0].rgb"),
            ('{"default": {"stiffness_N_m": 5}, "colours": [{"rgb": [1, 2, 300]}]}',
             "colours[0].rgb[2]: 300 is outside"),
            ('{"default": {"stiffness_N_m": 5}, "colours": [{"rgb": [1, 2, 3], "tolerance": -1}]}',
             "colours[0].tolerance"),
        ]
        for text, cause in cases:
            with self.subTest(text):
                done = self.run_tool("build", "scan.ply", "--material",
                                     self.write("bad.json", text), "-o", "bad.blob")
                self.assertEqual(done.returncode, 1)
                self.assertIn("bad.json: ", done.stderr)
                self.assertIn(cause, done.stderr)
                self.assertRegex(done.stderr, r"\(.*\)")
                self.assertFalse((self.path / "bad.blob").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
