"""Tests of the checks in scripts/ with planted violations, which a check must refuse and name.

usage: planted_test.py [CLASS...]        exit code 77: skipped
environment: CXX, the compiler of planted code; PAGE_BUILD, the build folder of the page
"""
import json
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CXX = os.environ.get("CXX", "c++")


def check(name, *arguments):
    """Exit code and output of a check."""
    done = subprocess.run([ROOT / "scripts" / name, *map(str, arguments)], capture_output=True,
                          text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class Planted(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def accepts(self, name, *arguments):
        code, output = check(name, *arguments)
        self.assertEqual(code, 0, output)

    def refuses(self, words, name, *arguments):
        code, output = check(name, *arguments)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)


class Layers(Planted):
    def setUp(self):
        super().setUp()
        for folder in ("core", "hal", "host", "tools"):
            shutil.copytree(ROOT / folder, self.folder / folder)
        self.accepts("check-layers", "--root", self.folder)

    def refuses_line(self, words, name, line):
        with open(self.folder / name, "a", encoding="utf-8") as file:
            file.write("\n" + line + "\n")
        self.refuses(words, "check-layers", "--root", self.folder)
        self.refuses(name + ":", "check-layers", "--root", self.folder)

    def test_contact_includes_control(self):
        self.refuses_line("contact includes tactree/core/control/controller.hpp of control",
                          "core/src/contact/scene.cpp", '#include "tactree/core/control/controller.hpp"')

    def test_unit_test_beside_another_subject(self):
        self.write("tests/unit/core/contact/octree_test.cpp", "")
        self.refuses("octree_test.cpp: is in core/contact, not in core/model",
                     "check-layers", "--root", self.folder)

    def test_core_includes_hosted_header(self):
        self.refuses_line("<vector>, which is not freestanding", "core/src/model/octree.cpp",
                          "#  include <vector>")

    def test_core_links_library(self):
        self.refuses_line("core links Eigen3::Eigen", "core/CMakeLists.txt",
                          "target_link_libraries(tactree_core PUBLIC Eigen3::Eigen)")

    def test_builder_uses_foreign_include_folder(self):
        self.refuses_line("of plant", "host/builder/CMakeLists.txt",
                          "target_include_directories(tactree_builder PRIVATE\n"
                          "  ${CMAKE_CURRENT_SOURCE_DIR}/../simulator/plant/include)")

    def test_empty_tree(self):
        self.refuses("nothing to check", "check-layers", "--root", self.write("a/b", "").parent)


class Loops(Planted):
    REFERENCE = "// Loop and memory annotations: docs/BOUND.md.\n"

    def refuses_code(self, code, line):
        self.write("a.cpp", self.REFERENCE + code)
        self.refuses(f"a.cpp:{line + 1}:", "check-loops", self.folder)

    def test_annotation_without_reference(self):
        code = "void f(int n) {\n  while (n > 0) --n;  // bound: n\n}\n"
        for text, line in ((code, 2), (code + self.REFERENCE, 2), ("// memory: RAM\n" + self.REFERENCE + code, 1)):
            self.write("a.cpp", text)
            self.refuses(f"a.cpp:{line}: annotation", "check-loops", self.folder)

    def test_while(self):
        self.refuses_code("void f(int n) {\n  while (n > 0) {\n    --n;\n  }\n}\n", 2)

    def test_goto(self):
        self.refuses_code("void f(int n) {\nagain:\n  if (--n) goto again;  // bound: n\n}\n", 3)

    def test_nothing_to_check(self):
        self.refuses("0 loops", "check-loops", self.write("c.txt", "").parent)


class Symbols(Planted):
    def archive(self, code, *flags):
        source = self.write("a.cpp", code)
        target = self.folder / "liba.a"
        subprocess.run([CXX, "-std=c++20", "-O2", "-ffp-contract=off", "-fno-exceptions",
                        "-fno-math-errno", *flags, "-c", source, "-o", self.folder / "a.o"], check=True)
        target.unlink(missing_ok=True)
        subprocess.run(["ar", "rcs", target, self.folder / "a.o"], check=True)
        return target

    def refuses_code(self, words, code, *flags):
        self.refuses(words, "check-symbols", self.archive(code, *flags))

    def test_heap(self):
        self.refuses_code("needs _Zna", "int* f(unsigned n) { return new int[n]; }\n")

    def test_zeroed_global(self):
        self.refuses_code(".bss", "static int counter;\nint f() { return ++counter; }\n")

    def test_constructor(self):
        self.refuses_code(".init_array", "int g(int);\nint f(int n) { return n; }\n"
                                         "extern int x;\nint x = f(__builtin_ia32_rdtsc() & 1);\n"
                          if platform.machine() == "x86_64" else
                          "struct A { A(); int n; };\nA::A() : n(1) { asm volatile(\"\"); }\nA a;\n")

    @unittest.skipUnless(platform.machine() == "x86_64", "instructions are only read on x86")
    def test_double(self):
        self.refuses_code("is not single precision", "float f(float a) { return float(a * 0.1); }\n")

    @unittest.skipUnless(platform.machine() == "x86_64", "instructions are only read on x86")
    def test_fused(self):
        self.refuses_code("fuses a product and a sum",
                          "float f(float a, float b, float c) { return a * b + c; }\n",
                          "-mfma", "-ffp-contract=fast")

    def test_empty_archive(self):
        self.refuses("0 symbols defined", "check-symbols", self.archive(""))


class Pages(Planted):
    """The tables of the documents, each with one number or source changed."""

    def setUp(self):
        super().setUp()
        for folder in ("core", "docs", "tests"):
            shutil.copytree(ROOT / folder, self.folder / folder,
                            ignore=shutil.ignore_patterns("corpus", "golden", "node_modules"))
        subprocess.run(["git", "init", "-q"], cwd=self.folder, check=True)

    def test_stale(self):
        headers = "core/include/tactree/core"
        for page, name, old, new in (
                ("PROTOCOL", "docs/PROTOCOL.md", "| 4 | 4 | u32 | `nonce`", "| 5 | 4 | u32 | `nonce`"),
                ("FORMAT", "docs/FORMAT.md", "| 7 | `kBadHeader` |", "| 7 | `kBadHeaders` |"),
                ("FORMAT", f"{headers}/model/blob_format.hpp", "std::uint32_t reserved[3];",
                 "std::uint32_t colour; std::uint32_t reserved[2];"),
                ("FORMAT", f"{headers}/model/blob_format.hpp", "kMaxMaterials = 255", "kMaxMaterials = 254"),
                ("SAFETY", f"{headers}/configuration/configuration.hpp", "force_max_N = 8.0F", "force_max_N = 9.0F"),
                ("SAFETY", "docs/SAFETY.md", "| **idle** | idle", "| **idle** | armed")):
            path = self.folder / name
            text = path.read_text()
            self.assertIn(old, text)
            path.write_text(text.replace(old, new, 1))
            self.refuses("differs from the sources", "generate", "--check", "--quick", "--root", self.folder, page)
            path.write_text(text)

    def test_measured_on_other_sources(self):
        subprocess.run(["git", "add", "core"], cwd=self.folder, check=True)
        self.refuses("campaign was measured on other sources", "generate", "--check", "--root", self.folder, "SAFETY")


class Style(Planted):
    def tidy(self, code):
        source = self.write("a.cpp", code)
        self.write("compile_commands.json", json.dumps(
            [{"directory": str(self.folder), "file": str(source),
              "command": f"c++ -std=c++20 -c {source}"}]))
        return "check-style", "tidy", self.folder, source

    def test_layout(self):
        self.accepts("check-style", "format", self.write("a.cpp", "int f(int a) { return a; }\n"))
        self.refuses("clang-format-violations", "check-style", "format",
                     self.write("a.cpp", "int  f( int a ){return a;}\n"))

    def test_complex_function(self):
        body = "".join(f"{'  ' * d}if (a > {d}) {{\n" for d in range(1, 9)) + "a = 0;\n" + "}" * 8
        self.refuses("readability-function-cognitive-complexity",
                     *self.tidy(f"int f(int a) {{\n{body}\n  return a;\n}}\n"))

    def test_file_of_no_build(self):
        source = self.write("b.cpp", "int f();\n")
        self.tidy("int g();\n")
        self.refuses("is not compiled in", "check-style", "tidy", self.folder, source)

    def build_of(self, *sources):
        """A build folder of host/ with these sources; those in a list are compiled as one file."""
        entries = []
        for number, source in enumerate(sources):
            if isinstance(source, list):
                source = self.write(f"host/support/merged/files_{number}.cpp",
                                    "".join(f'#include "{name}"\n' for name in source))
            entries.append({"directory": str(self.folder), "file": str(source),
                            "command": f"c++ -std=c++20 -o {number}.o -c {source}"})
        self.write("compile_commands.json", json.dumps(entries))
        return "check-style", "tidy", "--root", self.folder, self.folder

    GOOD = "int good(int value) { return value + 1; }\n"
    BAD = "int BadName(int value) { return value + 1; }\n"

    def test_merged_host_file(self):
        good = self.write("host/support/good.cpp", self.GOOD)
        bad = self.write("host/support/bad.cpp", self.BAD)
        self.refuses("host/support/bad.cpp:1:5", *self.build_of([good, bad]))
        self.accepts(*self.build_of([good, bad]), good)

    def test_unmergeable_files(self):
        one, two = (self.write(f"host/support/{name}.cpp", f"namespace {{\nint f() {{ return 1; }}\n}}\n"
                               f"int {name}() {{ return f(); }}\n") for name in ("one", "two"))
        self.accepts(*self.build_of(one, two))
        two.write_text(two.read_text() + self.BAD)
        self.refuses("host/support/two.cpp:5:5", *self.build_of(one, two))

    def test_firmware_of_host_build(self):
        self.write("firmware/bad.cpp", self.BAD)
        code, output = check(*self.build_of(self.folder / "firmware/bad.cpp"))
        self.assertEqual(code, 1)
        self.assertIn("nothing to check", output)


class Page(Planted):
    BUILD = pathlib.Path(os.environ.get("PAGE_BUILD", ROOT / "build/host-gcc/host/viewer/page"))

    def setUp(self):
        super().setUp()
        shutil.copy(ROOT / "host/viewer/page/biome.json", self.folder)

    def refuses_code(self, rule, code, name="a.ts"):
        self.write(name, code)
        self.refuses(rule, "check-page", self.BUILD, self.folder)
        self.refuses(name, "check-page", self.BUILD, self.folder)

    def test_any(self):
        self.refuses_code("noExplicitAny", "export const same = (value: any): any => value;\n")


class Tracked(Planted):
    # Split, so that this file passes the check.
    PATH = "/" + "home/somebody/tactree"

    def test_clean(self):
        self.write("a.txt", "https://example.org/" + "home/page and ${root}/" + "work/x\n")
        self.accepts("check-tracked", "--root", self.folder)

    def test_machine_path(self):
        self.write("b.md", f"first\nlook into {self.PATH}/core\n")
        self.refuses("b.md:2: path of a machine: /" + "home/somebody", "check-tracked", "--root", self.folder)

    def test_large_file(self):
        self.write("a.bin", "x" * (1 << 20))
        self.accepts("check-tracked", "--root", self.folder)
        self.write("a.bin", "x" * ((1 << 20) + 1))
        self.refuses("a.bin: 1048577 bytes", "check-tracked", "--root", self.folder)

    def test_long_source(self):
        for name, first in (("a.cpp", "// a\n"), ("script", "#!/usr/bin/env python3\n")):
            self.write(name, first + "x\n" * 599)
            self.accepts("check-tracked", "--root", self.folder)
            path = self.write(name, first + "x\n" * 600)
            self.refuses(f"{name}: 601 lines", "check-tracked", "--root", self.folder)
            path.unlink()
        self.write("data.csv", "1,2\n" * 700)
        self.accepts("check-tracked", "--root", self.folder)


class Scripts(Planted):
    def test_shell(self):
        self.accepts("check-scripts", "shell", self.write("a", '#!/bin/bash\nrm -- "$1"\n'))
        self.refuses("[SC2086]", "check-scripts", "shell", self.write("a", "#!/bin/bash\nrm -- $1\n"))

    def test_python(self):
        self.accepts("check-scripts", "python", self.write("a.py", "import sys\nprint(sys.argv)\n"))
        self.refuses("undefined name 'argv'", "check-scripts", "python", self.write("a.py", "print(argv)\n"))
        self.refuses("imported but unused", "check-scripts", "python", self.write("a.py", "import sys\n"))

    def test_help(self):
        for text, words in (("echo usage: a", None), ("echo a", "prints no usage"), ("echo usage: a; touch b", "writes files"),
                            ("echo usage: a; exit 2", "exit code 2")):
            script = self.write("a", f"#!/bin/sh\n{text}\n")
            script.chmod(0o755)
            if words:
                self.refuses(words, "check-scripts", "help", script)
            else:
                self.accepts("check-scripts", "help", script)


if __name__ == "__main__":
    if sys.argv[1:] == ["Page"] and not (Page.BUILD / "node_modules/.bin/biome").exists():
        print(f"skipped: {Page.BUILD} has no npm packages")
        sys.exit(77)
    sys.argv[0] = "planted_test.py"
    unittest.main(verbosity=2)
