"""A simulated board in a separate process, for tests of the commands that use a board."""
import math
import subprocess


def write_ball(path, points=3000):
    """A ball of 3 cm radius, with normals."""
    rows = ["x,y,z,nx,ny,nz"]
    for i in range(points):
        z = 1 - 2 * (i + 0.5) / points
        r, a = math.sqrt(1 - z * z), 2.399963 * i
        n = (r * math.cos(a), r * math.sin(a), z)
        rows.append(",".join(f"{v:.9g}" for v in (*(0.03 * c for c in n), *n)))
    path.write_text("\n".join(rows) + "\n")


def build_ball(tactree, folder, name="ball", *options):
    scan, blob = folder / "ball.csv", folder / f"{name}.blob"
    write_ball(scan)
    subprocess.run([tactree, "build", scan, "--unit", "m", "-o", blob, *options], check=True,
                   capture_output=True)
    return blob


class ServedBoard:
    """with ServedBoard(tactree, blob) as port: ...      Its time passes only while a program lets it."""

    def __init__(self, tactree, blob, *options):
        self.command = [tactree, "simulate", blob, "--serve", "--lock-step", *options]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        assert line.startswith("serving at "), line
        return line.removeprefix("serving at ").strip()

    def __exit__(self, *_):
        self.process.terminate()
        assert self.process.wait(timeout=60) == 0
        self.process.stdout.close()
