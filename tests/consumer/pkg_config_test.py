"""Programs of projects without CMake, by the .pc files of the installation: linked statically and with the shared
library, also in a shared object, and after the installation was moved. Projects with CMake and only parts of it.

usage: pkg_config_test.py C++_COMPILER PREFIX WORK SOURCES BUILD
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

CXX, PREFIX, WORK, SOURCES, BUILD = sys.argv[1], *map(pathlib.Path, sys.argv[2:6])
del sys.argv[1:]
HERE = pathlib.Path(__file__).resolve().parent
LIBRARY = "libtactree-client.so"


def output(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
    return done.stdout


class PkgConfig(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)
        # The files name no folder of the build.
        cls.prefix = WORK / "moved"
        shutil.copytree(PREFIX, cls.prefix, symlinks=True)
        cls.folder = next(cls.prefix.rglob("pkgconfig"))

    def flags(self, package):
        paths = os.environ | {"PKG_CONFIG_PATH": str(self.folder)}
        return output("pkg-config", "--cflags", "--libs", package, env=paths).split()

    def test_c_program_with_the_shared_library(self):
        program = WORK / "client_c"
        output("gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", HERE / "pkg_config/client.c", "-o", program,
               *self.flags("tactree-client-c"))
        needed = output("readelf", "-d", program)
        self.assertIn(f"[{LIBRARY}.0]", needed)
        output(program, env={"LD_LIBRARY_PATH": str(self.folder.parent)})

    def test_cxx_program_with_the_static_library(self):
        program = WORK / "client_cpp"
        output(CXX, HERE / "pkg_config/client.cpp", "-o", program, *self.flags("tactree-client"))
        self.assertNotIn("tactree", output("readelf", "-d", program))
        output(program)

    def test_builder_and_simulation(self):
        program = WORK / "builder"
        output(CXX, HERE / "builder/main.cpp", "-o", program, *self.flags("tactree-builder"),
               *self.flags("tactree-simulation"))
        output(program, WORK / "sphere.blob")
        output(self.prefix / "bin/tactree", "check", WORK / "sphere.blob")

    def test_core_alone_in_a_shared_object(self):
        flags = self.flags("tactree-core")
        self.assertIn("-ffp-contract=off", flags)
        output(CXX, "-shared", "-fPIC", "-Wl,-z,defs", HERE / "pkg_config/touch.cpp", "-o", WORK / "libtouch.so", *flags)

    def test_shared_library_exports_its_interface_only(self):
        header = (SOURCES / "host/client/include/tactree/client/tactree.h").read_text()
        declared = set(re.findall(r"\b(tactree_\w+)\(", re.sub(r"/\*.*?\*/", "", header, flags=re.S)))
        self.assertGreater(len(declared), 15)
        symbols = output("nm", "--dynamic", "--defined-only", self.folder.parent / LIBRARY)
        exported = {line.split()[2] for line in symbols.splitlines()} - {"TACTREE_CLIENT_0"}
        self.assertEqual(exported, {f"{name}@@TACTREE_CLIENT_0" for name in declared})
        exports = (SOURCES / "host/client/exported_symbols.map").read_text()
        self.assertNotIn("*", re.search(r"global:(.*?)local:", exports, re.S)[1])  # no later function joins by itself
        packaged = (SOURCES / "debian/libtactree-client0.symbols").read_text()
        self.assertEqual(set(re.findall(r"^ (tactree_\w+)@", packaged, re.M)), declared)

    def test_components_are_installed_alone(self):
        for component, wanted, unwanted in (("client-library", f"{LIBRARY}.0", LIBRARY),
                                            ("tools", "tactree", LIBRARY),
                                            ("core", "tactree-core.pc", "tactree-client.pc")):
            prefix = WORK / component
            output("cmake", "--install", BUILD, "--component", component, "--prefix", prefix)
            names = {path.name for path in prefix.rglob("*") if not path.is_dir()}
            self.assertIn(wanted, names)
            self.assertNotIn(unwanted, names)


    def build_client_c(self, name, prefix, *options):
        """What the program needs, of a project that finds the library by find_package()."""
        folder = WORK / f"build-{name}"
        output("cmake", "-S", HERE / "client_c", "-B", folder, f"-DCMAKE_CXX_COMPILER={CXX}",
               f"-DCMAKE_PREFIX_PATH={prefix}", *options)
        output("cmake", "--build", folder)
        output("ctest", "--test-dir", folder, "--output-on-failure", "--no-tests=error")
        return output("readelf", "-d", folder / "consumer")

    def test_shared_library_by_find_package(self):
        self.assertIn(f"[{LIBRARY}.0]", self.build_client_c("shared", self.prefix))

    def test_client_without_its_shared_library(self):
        for component in ("core", "client"):
            output("cmake", "--install", BUILD, "--component", component, "--prefix", WORK / "static")
        self.assertNotIn(LIBRARY, self.build_client_c("static", WORK / "static", "-DWITHOUT_LIBRARY=ON"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
