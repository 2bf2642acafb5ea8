"""A simulated board in a separate process, for tests of the commands that use a board."""
import subprocess

from tool_folder import SharedFolder, ball, csv


def build_ball(tactree, folder, name="ball", *options, points=3000, radius=0.03):
    scan, blob = folder / "ball.csv", folder / f"{name}.blob"
    scan.write_text(csv(ball(points, radius)))
    subprocess.run([tactree, "build", scan, "--unit", "m", "-o", blob, *options], check=True,
                   capture_output=True)
    return blob


class BallFolder(SharedFolder):
    """With the blob of a ball, which `tool` builds."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.blob = build_ball(cls.tool, cls.path)


class ServedBoard:
    """with ServedBoard(tactree, blob) as port: ...      Its time passes only while a program lets it."""

    def __init__(self, tactree, blob, *options, env=None):
        self.env = env
        self.command = [tactree, "simulate", blob, "--serve", "--lock-step", *options]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True, env=self.env)
        line = self.process.stdout.readline()
        assert line.startswith("serving at "), line
        return line.removeprefix("serving at ").strip()

    def __exit__(self, *_):
        self.process.terminate()
        assert self.process.wait() == 0
        self.process.stdout.close()
