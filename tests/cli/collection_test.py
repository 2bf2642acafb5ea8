"""`tactree build --collection`: one blob per scan, in parts, and again after a change or a crash.

usage: collection_test.py TACTREE [CLASS]
"""
import contextlib
import csv
import json
import math
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import CORNERS, FACES, ToolFolder, new_folder, sphere  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
LAUNCHERS = ("SLURM_", "OMPI_", "PMI_")
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith(LAUNCHERS)}


def ball(radius):
    return sphere(800, radius)


def sheet():
    return "".join(f"{0.001 * i} {0.001 * j} {0.002 * math.sin(0.1 * i)}\n" for i in range(60) for j in range(60))


def kill_child_of(process):
    """Its only child, as soon as there is one."""
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None:
        if child := children.read_text(encoding="ascii"):
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(child), signal.SIGKILL)
            break


class Folder(ToolFolder):
    """Each test has two scans of the same name in a folder `scans`."""
    tool = TACTREE
    scans = {"a.xyz": ball(0.05), "sub/a.xyz": ball(0.04)}

    def setUp(self):
        type(self).path = new_folder(self.addCleanup)
        for name, content in self.scans.items():
            self.write_scan(name, content)

    def write_scan(self, name, content):
        file = self.path / "scans" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content)

    def collect(self, *options, scans="scans", code=0, env=None, **others):
        """Runs the command; its lines as {name: result}."""
        done = self.run_tool("build", "--collection", scans, "-o", "out", "--json", "r.json", *options,
                             env={**ENVIRONMENT, **(env or {})}, **others)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.done = done
        rows = [line.split() for line in done.stdout.splitlines()]
        return {row[2].rstrip(":"): row[0] for row in rows if len(row) > 2 and row[1][0].isdigit() and "/" in row[1]
                and row[0] != "part"}

    def built(self, folder="out"):
        """The contents of all blobs and pictures."""
        return {str(file.relative_to(self.path / folder)): file.read_bytes()
                for file in sorted((self.path / folder).rglob("*")) if file.suffix in (".blob", ".png")}

    def manifest(self):
        with open(self.path / "out/manifest.csv", encoding="utf-8", newline="") as file:
            return {row["name"]: row for row in csv.DictReader(file)}


class Results(Folder):
    def test_gives_blobs_of_single_builds(self):
        self.assertEqual(self.collect("--scale", "0.9"), {"a.xyz": "ok", "sub/a.xyz": "ok"})
        for name in self.scans:
            self.run_tool("build", f"scans/{name}", "-o", "y", "--preview", "y.png", "--scale", "0.9")
            self.assertEqual((self.path / "y").read_bytes(), self.built()[f"{name}.blob"])
            self.assertEqual((self.path / "y.png").read_bytes(), self.built()[f"{name}.png"])
        self.assertNotEqual(self.built()["a.xyz.blob"], self.built()["sub/a.xyz.blob"])

    def test_manifest_and_page_list_every_object(self):
        self.write_scan("sheet.xyz", sheet())
        self.write_scan("<b> & \"c\".xyz", "no scan, but text\n")
        self.write_scan("notes.doc", "not a scan by its name")
        found = self.collect(code=1)
        self.assertEqual(found["sheet.xyz"], "ambiguous")
        self.assertIn("left out  1 file without", self.done.stdout)
        rows = self.manifest()
        self.assertEqual({name: row["result"] for name, row in rows.items()},
                         {"a.xyz": "ok", "sub/a.xyz": "ok", "sheet.xyz": "ambiguous", "<b> & \"c\".xyz": "failed"})
        self.assertIn("ambiguous", rows["sheet.xyz"]["warnings"])
        self.assertEqual(int(rows["a.xyz"]["bytes"]), (self.path / "out/a.xyz.blob").stat().st_size)
        page = (self.path / "out/index.html").read_text()
        self.assertIn("&lt;b&gt; &amp; &quot;c&quot;.xyz", page)
        self.assertIn('src="./sub/a.xyz.png"', page)
        self.assertNotIn("://", page)
        self.assertEqual(page.count("<tr>"), 1 + len(rows))

    def test_failure_stops_no_other_object(self):
        self.collect()
        self.write_scan("a.xyz", "ply\nformat nonsense 1.0\n")
        for _ in range(2):  # a failure is tried again
            self.assertEqual(self.collect(code=1), {"a.xyz": "failed", "sub/a.xyz": "unchanged"})
        self.assertIn("1 of 2 objects failed", self.done.stderr)
        self.assertRegex(self.done.stderr, r"\n  scans/a\.xyz: .*nonsense.* \(.*\)\n")
        summary = self.read("r.json")
        self.assertEqual((summary["objects"], summary["results"]), (2, {"failed": 1, "unchanged": 1}))
        self.assertEqual([failure["name"] for failure in summary["failures"]], ["a.xyz"])
        # The blob of the former scan is not left beside the failure.
        self.assertEqual(set(self.built()), {"sub/a.xyz.blob", "sub/a.xyz.png"})

    def test_reads_list(self):
        shutil.copy(self.path / "scans/a.xyz", self.path / "elsewhere.xyz")
        self.write("scans/list.txt", "# two of three\n\n  sub/a.xyz \r\nsub/../sub/a.xyz\n"
                   f"{self.path / 'elsewhere.xyz'}\nnone.xyz\n")
        found = self.collect(scans="scans/list.txt", code=1)
        outside = str(self.path / "elsewhere.xyz")[1:]
        self.assertEqual(found, {"sub/a.xyz": "ok", outside: "ok", "none.xyz": "failed"})
        self.assertIn("scans/none.xyz", self.done.stderr)
        self.assertTrue((self.path / "out" / f"{outside}.blob").is_file())
        same = self.path / "scans" / outside
        same.parent.mkdir(parents=True)
        same.write_text(ball(0.05))
        self.write("scans/list.txt", f"{outside}\n/{outside}\n")
        self.collect(scans="scans/list.txt", code=1)
        self.assertIn("same name in the output", self.done.stderr)


class Restart(Folder):
    def files(self):
        return {file: file.stat().st_ino for file in (self.path / "out").rglob("*.blob")}

    def test_skips_unchanged(self):
        self.collect()
        before = self.files()
        self.assertEqual(self.collect("--threads", "1", "--progress", "off"),
                         {"a.xyz": "unchanged", "sub/a.xyz": "unchanged"})
        self.assertEqual(self.files(), before)

    def test_rebuilds_what_changed(self):
        self.collect()
        first = self.built()
        self.write_scan("a.xyz", ball(0.06))
        self.assertEqual(self.collect(), {"a.xyz": "ok", "sub/a.xyz": "unchanged"})
        self.assertNotEqual(self.built()["a.xyz.blob"], first["a.xyz.blob"])
        for stiffness in (400, 500):  # another option, then another content of its file
            self.write("m.json", {"default": {"stiffness_N_m": stiffness}})
            self.assertEqual(set(self.collect("--material", "m.json").values()), {"ok"})

    def test_rebuilds_damaged_outputs(self):
        self.collect()
        first = self.built()
        damaged = self.path / "out/a.xyz.blob"
        damaged.write_bytes(damaged.read_bytes()[:-4])
        (self.path / "out/sub/a.xyz.png").unlink()
        self.assertEqual(self.collect(), {"a.xyz": "ok", "sub/a.xyz": "ok"})
        damaged.unlink()
        (self.path / "out/sub/a.xyz.json").write_text("{")
        self.assertEqual(self.collect(), {"a.xyz": "ok", "sub/a.xyz": "ok"})
        self.assertEqual(self.built(), first)

    def test_rebuilds_after_change_of_gltf_buffer(self):
        shutil.rmtree(self.path / "scans")
        indices = struct.pack("<36H", *(i for face in FACES for i in face))
        self.write_scan("a.gltf", json.dumps({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"uri": "a%20b.bin", "byteLength": 96 + len(indices)}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96},
                            {"buffer": 0, "byteOffset": 96, "byteLength": len(indices)}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
                           "min": [0, 0, 0], "max": [10, 10, 10]},
                          {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}))
        for scale, result in ((1.0, "ok"), (1.0, "unchanged"), (0.9, "ok")):
            corners = struct.pack("<24f", *(scale * c for corner in CORNERS for c in corner))
            (self.path / "scans/a b.bin").write_bytes(corners + indices)
            self.assertEqual(self.collect("--scale", "0.01", "--spacing", "0.005"), {"a.gltf": result})

    def test_kill_loses_one_object(self):
        self.write_scan("large.xyz", sphere(40000, 0.05))
        command = [TACTREE, "build", "--collection", "scans", "-o", "out"]
        with subprocess.Popen(command, cwd=self.path, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True) as process:
            for line in process.stdout:
                if " 1/3 a.xyz" in line:
                    break
            process.kill()
        for name, blob in self.built().items():  # no half one
            if name.endswith(".blob"):
                self.assertEqual(self.run_tool("check", "-", text=False, input=blob).returncode, 0)
        found = self.collect()
        self.assertEqual(found["a.xyz"], "unchanged")
        self.assertEqual(set(self.collect().values()), {"unchanged"})
        self.assertEqual(len(self.built()), 6)

    def crash_second_object(self):
        shutil.rmtree(self.path / "out", ignore_errors=True)
        command = [TACTREE, "build", "--collection", "scans", "-o", "out"]
        with subprocess.Popen(command, cwd=self.path, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            for line in process.stdout:
                if " 1/3 a.xyz" in line:
                    break
            kill_child_of(process)
            _, errors = process.communicate()
        return process.returncode, errors

    def test_crash_ends_one_object(self):
        self.write_scan("large.xyz", sphere(40000, 0.05))
        for _ in range(10):  # this process may be too late
            code, errors = self.crash_second_object()
            if "scans/large.xyz: the build was ended by signal 9 (" in errors:
                break
        self.assertIn("scans/large.xyz: the build was ended by signal 9 (", errors)
        self.assertEqual(code, 1)
        self.assertEqual({name: row["result"] for name, row in self.manifest().items()},
                         {"a.xyz": "ok", "large.xyz": "failed", "sub/a.xyz": "ok"})


class Parts(Folder):
    scans = {f"{i}.xyz": ball(0.05 + 0.001 * i) for i in range(5)}

    def test_parts_cover_each_object_once(self):
        self.collect()
        whole = self.built()
        (self.path / "out").rename(self.path / "whole")
        found = [self.collect("--part", f"{k}/3") for k in (1, 2, 3)]
        self.assertEqual(sorted(name for part in found for name in part), sorted(self.scans))
        self.assertEqual({result for part in found for result in part.values()}, {"ok"})
        self.assertEqual(self.built(), whole)
        self.assertFalse((self.path / "out/manifest.csv").exists())
        self.collect("--collect")
        self.assertEqual({row["result"] for row in self.manifest().values()}, {"ok"})
        (self.path / "out/2.xyz.blob").unlink()
        self.collect("--collect", code=1)
        self.assertEqual(self.manifest()["2.xyz"]["result"], "missing")
        self.assertIn("2.xyz.blob: does not exist (run the build of its part again)", self.done.stderr)


class Environment(Folder):
    """The scans are refused as soon as they are read: only the choice of the part matters."""
    scans = {f"{i}.xyz": "" for i in range(8)}

    def part(self, *options, **variables):
        self.collect(*options, code=1, env=variables)
        return self.done.stdout.splitlines()[0] if self.done.stdout else self.done.stderr

    def test_launchers_state_part(self):
        self.assertEqual(self.part(), "part      1/1: 8 of 8 objects")
        slurm = {"SLURM_ARRAY_TASK_COUNT": "4", "SLURM_ARRAY_TASK_MIN": "10", "SLURM_ARRAY_TASK_MAX": "16",
                 "SLURM_ARRAY_TASK_STEP": "2"}
        for index, number in (("10", 1), ("16", 4)):
            self.assertEqual(self.part(**slurm, SLURM_ARRAY_TASK_ID=index),
                             f"part      {number}/4 (SLURM_ARRAY_TASK_ID={index}, SLURM_ARRAY_TASK_COUNT=4): 2 of 8 objects")
        for launcher in ("OMPI_COMM_WORLD", "PMI"):
            ranks = {f"{launcher}_RANK": "2", f"{launcher}_SIZE": "3"}
            self.assertEqual(self.part(**ranks), f"part      3/3 ({launcher}_RANK=2, {launcher}_SIZE=3): 2 of 8 objects")
        self.assertEqual(self.part("--part", "1/8", **ranks), "part      1/8 (--part): 1 of 8 objects")

    def test_refuses_unclear_variables(self):
        uneven = {"SLURM_ARRAY_TASK_COUNT": "3", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "7"}
        for index in ("1", "3", "7"):
            self.assertIn("not evenly spaced", self.part(**uneven, SLURM_ARRAY_TASK_ID=index))
        self.assertIn("not below the count", self.part(PMI_RANK="3", PMI_SIZE="3"))
        self.assertIn("is not a whole number", self.part(PMI_RANK="-1", PMI_SIZE="3"))
        self.assertIn("PMI_SIZE: is not set", self.part(PMI_RANK="1"))
        self.assertIn("two launchers", self.part(PMI_RANK="0", PMI_SIZE="3", OMPI_COMM_WORLD_RANK="0",
                                                 OMPI_COMM_WORLD_SIZE="3"))
        self.assertFalse((self.path / "out").exists())

    def test_refuses_wrong_usage(self):
        for options, cause in ((("--part", "0/3"), "K/N"), (("--part", "4/3"), "K/N"), (("--part", "x"), "K/N"),
                               (("--part", "1/2", "--collect"), "excludes"), (("scans/0.xyz",), "excludes"),
                               (("--preview", "y.png"), "excludes")):
            self.collect(*options, code=2)
            self.assertIn(cause, self.done.stderr)
        for arguments, cause in ((("-o", "y"), "INPUT is required"), (("scans/0.xyz", "-o", "y", "--part", "1/2"),
                                                                      "--collection")):
            done = self.run_tool("build", *arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(cause, done.stderr)
        done = self.run_tool("build", "--collection", "scans", "-o", "scans/.")
        self.assertIn("is the folder of the scans", done.stderr)
        (self.path / "empty").mkdir()
        self.collect(scans="empty", code=1)
        self.assertIn("empty: has no scans", self.done.stderr)
        for place in ("empty", "nowhere"):
            done = self.run_tool("build", "--collection", place, "-o", "never")
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(place, done.stderr)
            self.assertFalse((self.path / "never").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
