"""A folder with a scan in which tests run the tool, and small scans in files."""
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


def sphere(count, radius):
    """Evenly spread points, one text line each."""
    golden = math.pi * (3 - math.sqrt(5))
    lines = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        ring = math.sqrt(1 - z * z)
        lines.append(f"{radius * ring * math.cos(golden * i)} "
                     f"{radius * ring * math.sin(golden * i)} {radius * z}")
    return "\n".join(lines) + "\n"


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


class ToolFolder(unittest.TestCase):
    """Each test has a folder of its own, with `points` points of a ball in s.xyz."""
    tool: pathlib.Path
    points = 2000

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        (self.path / "s.xyz").write_text(sphere(self.points, 0.05))

    def run_tool(self, *arguments, **options):
        options = {"capture_output": True, "text": True, "timeout": 60, **options}
        return subprocess.run([self.tool, *arguments], cwd=self.path, check=False, **options)

    def build(self, *arguments):
        done = self.run_tool("build", "s.xyz", "-o", "s.blob", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done
