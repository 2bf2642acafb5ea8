"""A folder with a scan in which tests run the tool, and small scans in files."""
import json
import math
import pathlib
import subprocess
import tempfile
import unittest
import zipfile

# A cube of 10 units.
CORNERS = [(x, y, z) for z in (0, 10) for y in (0, 10) for x in (0, 10)]
FACES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
         (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def ball(count, radius):
    """Evenly spread points of a ball around the origin: its coordinates and its normal, of each."""
    for i in range(count):
        z, turn = 1 - (2 * i + 1) / count, i * math.pi * (3 - math.sqrt(5))
        ring = math.sqrt(1 - z * z)
        normal = (ring * math.cos(turn), ring * math.sin(turn), z)
        yield [radius * c for c in normal], normal


def sheet(half_m, step_m, height_m=0.0):
    """Points of a square sheet, normals up."""
    steps = [step_m * i for i in range(-round(half_m / step_m), round(half_m / step_m) + 1)]
    return [((x, y, height_m), (0, 0, 1)) for x in steps for y in steps]


def csv(points):
    return "x,y,z,nx,ny,nz\n" + "".join(",".join(f"{v:.9g}" for v in (*p, *n)) + "\n" for p, n in points)


def sphere(count, radius):
    """Points of a ball, one text line each."""
    return "".join(f"{p[0]} {p[1]} {p[2]}\n" for p, _ in ball(count, radius))


def write_3mf(path, target="3D/a.model", *pictures, unit="millimeter"):
    """The cube, as the part `target` of an archive, behind pictures."""
    vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % corner for corner in CORNERS)
    faces = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in FACES)
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    package = "http://schemas.openxmlformats.org/package/2006/"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for picture in pictures:
            archive.writestr(picture, bytes(100000), zipfile.ZIP_STORED)
        archive.writestr("[Content_Types].xml", f'<Types xmlns="{package}content-types"/>')
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{package}relationships">'
                         f'<Relationship Target="/{target}" Id="r" Type="http://schemas.'
                         'microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        archive.writestr(target, f'<model unit="{unit}" xmlns="{core}"><resources>'
                         f'<object id="1"><mesh><vertices>{vertices}</vertices><triangles>'
                         f'{faces}</triangles></mesh></object></resources><build>'
                         '<item objectid="1"/></build></model>')


def new_folder(add_cleanup):
    folder = tempfile.TemporaryDirectory()
    add_cleanup(folder.cleanup)
    return pathlib.Path(folder.name)


class SharedFolder(unittest.TestCase):
    """Runs the tool in a folder that all tests of a class share."""
    tool: pathlib.Path

    @classmethod
    def setUpClass(cls):
        cls.path = new_folder(cls.addClassCleanup)

    @classmethod
    def run_tool(cls, *arguments, **options):
        options = {"capture_output": True, "text": True, "check": False, **options}
        return subprocess.run([cls.tool, *map(str, arguments)], cwd=cls.path, **options)

    @classmethod
    def build_points(cls, name, points, *options):
        """NAME.csv and NAME.blob."""
        cls.write(f"{name}.csv", csv(points))
        done = cls.run_tool("build", f"{name}.csv", "-o", f"{name}.blob", "--progress", "off", *options)
        assert done.returncode == 0, done.stderr

    @classmethod
    def write(cls, name, content):
        (cls.path / name).write_text(content if isinstance(content, str) else json.dumps(content))
        return name

    def read(self, name):
        return json.loads((self.path / name).read_text())


class ToolFolder(SharedFolder):
    """Each test has a folder of its own, with `points` points of a ball in s.xyz."""
    points = 2000

    def setUp(self):
        type(self).path = new_folder(self.addCleanup)
        self.write("s.xyz", sphere(self.points, 0.05))

    def build(self, *arguments):
        done = self.run_tool("build", "s.xyz", "-o", "s.blob", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done
