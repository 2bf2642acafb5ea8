"""Device files: tactree device check, schema and to-header; what other commands say of their defaults.

usage: device_test.py TACTREE
"""
import json
import pathlib
import re
import sys
import unittest

import jsonschema

sys.dont_write_bytecode = True
from tool_folder import SharedFolder  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
KINDS = {"cartesian": "cartesian", "arm": "premium", "delta": "falcon", "five-bar": "pantograph", "paddle": "hapkit"}


def put(key, value):
    return lambda device: device.update({key: value})


# The mistake, the field that the check names, a part of its message, and whether the schema refuses the file, too.
# A schema cannot compare values, and a JSON reader keeps the last of several equal keys.
MISTAKES = [
    (put("ratoi", [1, 1, 1]), "ratoi", "did you mean 'ratio'", True),
    (put("counts_per_m", [1, 1, 1]), "counts_per_m", "does not belong to a device of this kind", True),
    (lambda device: device.pop("joint_min"), "joint_min", "is missing", True),
    (lambda device: device.pop("kind"), "kind", "is missing", True),
    (put("kind", "arms"), "kind", "did you mean 'arm'", True),
    (put("kind", 3), "kind", "is not a string", True),
    (put("homing", "none"), "homing", "one of: absolute, given-pose, index, hard-stop", True),
    (put("name", ["a"]), "name", "is not a string", True),
    (put("force_max_N", "8"), "force_max_N", "without quotes", True),
    (put("force_max_N", None), "force_max_N", "is not a number", True),
    (put("force_max_N", 1e39), "force_max_N", "is out of range", True),
    (put("arm_m", 0.009), "arm_m", "give 0.01 .. 10", True),
    (put("effort_max", 1), "effort_max", "is not a list of three numbers", True),
    (put("effort_max", [1, 1]), "effort_max", "is not a list of three numbers", True),
    (put("effort_max", [1, True, 1]), "effort_max[1]", "is not a number", True),
    (put("joint_min", [-1.1, -101, -1]), "joint_min[1]", "give -100 .. 100", True),
    (put("ratio", [13, 0, 11]), "ratio[1]", "is too close to 0", True),
    (put("ratio", [13, -9e-4, 11]), "ratio[1]", "at most -0.001", True),
    (put("joint_min", [2, -1, -1]), "joint_min[0]", "is not below joint_max", False),
    (put("home_position", [0, 0, 3]), "home_position[2]", "give -0.9 .. 1.1", False),
    (put("joint_margin", [2, 0, 0]), "joint_margin[0]", "more than half", False),
]


def field_of(error):
    path = list(error.absolute_path)
    return "".join(f"[{part}]" if isinstance(part, int) else part for part in path)


class DeviceFiles(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        schema = json.loads(cls.run_tool("device", "schema").stdout)
        jsonschema.Draft7Validator.check_schema(schema)
        cls.schema = jsonschema.Draft7Validator(schema)

    def device(self, name="premium"):
        done = self.run_tool("simulate", "--device", name, "--dump-device")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def check(self, device):
        """What the tool answers, and what it writes as JSON."""
        self.write("own.json", device if isinstance(device, str) else json.dumps(device, indent=2))
        done = self.run_tool("device", "check", "own.json", "--json", "report.json")
        report = self.read("report.json")
        self.assertEqual(done.returncode, 0 if report["valid"] else 1)
        self.assertEqual(report["valid"], not report["mistakes"])
        return done, report

    def test_schema_agrees_with_check(self):
        for change, field, message, seen_by_schema in MISTAKES:
            device = self.device()
            change(device)
            with self.subTest(field, message=message):
                done, report = self.check(device)
                found = [mistake for mistake in report["mistakes"] if mistake["field"] == field]
                self.assertEqual(len(found), 1, report)
                self.assertIn(message, f"{found[0]['cause']} ({found[0]['remedy']})")
                text = f"own.json:{found[0]['line']}:{found[0]['column']}: {field}: "
                self.assertIn(text, done.stderr)
                lines = (self.path / "own.json").read_text().splitlines()
                key = field.split("[")[0]
                if key in device:
                    at = found[0]["line"] - 1
                    context = "".join(lines[max(0, at - 3):at + 1])
                    self.assertIn(f'"{key}"', context)
                self.assertEqual(self.schema.is_valid(device), not seen_by_schema)

    def test_names_all_mistakes_at_once(self):
        device = self.device()
        for change, field, *_ in MISTAKES:
            if field in ("ratoi", "counts_per_m", "joint_min", "arm_m", "homing"):
                change(device)
        done, report = self.check(device)
        self.assertEqual(len(report["mistakes"]), 5)
        self.assertEqual(len(done.stderr.splitlines()), 5)
        order = [(mistake["line"], mistake["column"]) for mistake in report["mistakes"]]
        self.assertEqual(order, sorted(order))
        # Every command that reads the file answers the same.
        again = self.run_tool("simulate", "no.blob", "--device", "own.json", "--dump-device")
        self.assertEqual(again.returncode, 1)
        self.assertEqual(again.stderr, done.stderr)

    def limits(self, kind):
        """The schemas of the keys of a kind: those of its numbers, by field."""
        [branch] = [entry["then"] for entry in self.schema.schema["allOf"]
                    if entry["if"]["properties"]["kind"]["const"] == kind]
        for key, schema in branch["properties"].items():
            if schema["type"] == "number":
                yield key, None, schema
            elif schema["type"] == "array":
                items = schema["items"]
                for i, item in enumerate(items if isinstance(items, list) else 3 * [items]):
                    yield key, i, item

    @staticmethod
    def ends(schema):
        parts = schema.get("anyOf", [schema])
        return min(part["minimum"] for part in parts), max(part["maximum"] for part in parts)

    def with_values(self, kind, value_of):
        device = self.device(KINDS[kind])
        for key, i, schema in self.limits(kind):
            value = value_of(*self.ends(schema))
            if i is None:
                device[key] = value
            else:
                device[key] = device[key][:i] + [value] + device[key][i + 1:]
        return device

    def test_range_ends_agree(self):
        relations = re.compile(r"(joint_min|home_position|joint_margin)\[")
        for kind in KINDS:
            for end in (0, 1):
                with self.subTest(kind, end=end):
                    device = self.with_values(kind, lambda *ends, end=end: ends[end])
                    self.assertTrue(self.schema.is_valid(device))
                    _, report = self.check(device)
                    self.assertEqual([mistake for mistake in report["mistakes"] if not relations.match(mistake["field"])], [])
                    sign = (-1, 1)[end]
                    beyond = self.with_values(kind, lambda *ends, end=end, sign=sign:
                                              ends[end] + sign * max(1e-6 * abs(ends[end]), 1e-9))
                    expected = {field_of(error) for error in self.schema.iter_errors(beyond)}
                    expected |= {field_of(inner) for error in self.schema.iter_errors(beyond) for inner in error.context or []}
                    _, report = self.check(beyond)
                    self.assertEqual({mistake["field"] for mistake in report["mistakes"]}, expected - {""})
                    self.assertEqual(len(report["mistakes"]), len(list(self.limits(kind))))

    def test_states_defaults_of_schema(self):
        for kind, preset in KINDS.items():
            with self.subTest(kind):
                [branch] = [entry["then"] for entry in self.schema.schema["allOf"]
                            if entry["if"]["properties"]["kind"]["const"] == kind]
                full = self.device(preset)
                device = {key: full[key] for key in branch["required"]}
                self.assertTrue(self.schema.is_valid(device))
                done, report = self.check(device)
                defaults = {key: schema["default"] for key, schema in branch["properties"].items()
                            if "default" in schema and key != "about"}
                self.assertEqual({used["field"] for used in report["defaults"]}, set(defaults))
                for used in report["defaults"]:
                    self.assertIn(f"{used['field']} = {used['value']}: {used['consequence']}", done.stdout)
                completed = self.device("own.json")
                self.assertEqual({key: completed[key] for key in defaults}, defaults)
                for key in branch["required"]:
                    self.assertEqual(completed[key], full[key])

    def test_simulation_states_defaults(self):
        device = self.device("cartesian")
        del device["tip_mass_kg"]
        self.write("own.json", device)
        points = [((0.0, 0.001 * i, 0.001 * j), (1, 0, 0)) for i in range(-15, 16) for j in range(-15, 16)]
        self.build_points("sheet", points)
        done = self.run_tool("simulate", "sheet.blob", "--device", "own.json", "--seconds", "0.01", "--allow-no-contact")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("note: own.json: defaults: tip_mass_kg = 0 (", done.stderr)
        done = self.run_tool("simulate", "sheet.blob", "--device", "cartesian", "--seconds", "0.01", "--allow-no-contact")
        self.assertNotIn("defaults", done.stderr)

    def test_writes_header_of_valid_devices_only(self):
        self.write("own.json", self.device())
        done = self.run_tool("device", "to-header", "own.json", "-o", "own.hpp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("DevicePreset kDevice = ", (self.path / "own.hpp").read_text())
        done = self.run_tool("device", "to-header", "own.json", "-o", "-")
        self.assertEqual(done.stdout, (self.path / "own.hpp").read_text())
        self.assertIn("wrote", done.stderr)
        self.write("own.json", {"kind": "arm"})
        before = (self.path / "own.hpp").read_text()
        self.assertEqual(self.run_tool("device", "to-header", "own.json", "-o", "own.hpp").returncode, 1)
        self.assertEqual((self.path / "own.hpp").read_text(), before)
        for name in ("2a", "a-b", ""):
            done = self.run_tool("device", "to-header", "premium", "-o", "own.hpp", "--name", name)
            self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(self.run_tool("device", "to-header", "own.json", "-o", "own.json").returncode, 1)

    def test_presets_are_valid(self):
        done = self.run_tool("device", "check", "hapkit")
        self.assertEqual((done.returncode, done.stdout), (0, "hapkit: valid: hapkit, 1 axis\n"), done.stderr)

    def test_names_unreadable_file(self):
        done = self.run_tool("device", "check", "none.json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("'none.json' is neither a device nor a readable file", done.stderr)
        self.assertEqual(self.run_tool("device").returncode, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
