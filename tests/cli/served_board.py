"""A simulated board in a separate process, for tests of the commands that use a board."""
import re
import signal
import subprocess

from tool_folder import SharedFolder, ball, csv
from web_socket import WebSocket


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


class RealTimeBoard(ServedBoard):
    """At a pseudo-terminal: the board does not wait for the program."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.command.remove("--lock-step")


class SharingProgram:
    """with SharingProgram(tactree, "--port", port) as shared: ...      tactree serve; ends with exit code 0."""

    def __init__(self, tactree, *arguments, cwd=None):
        self.process = subprocess.Popen([tactree, "serve", *arguments, "--tcp-port", "0"], stdout=subprocess.PIPE,
                                        text=True, cwd=cwd)
        self.said = ""

    def __enter__(self):
        self.address = self.wait_for(r"ws://[\d.]+:(\d+)/\S*")
        self.tcp_port = int(self.address[1])
        self.watch_port = self.wait_for(r"unix:\S+")[0]
        return self

    def wait_for(self, pattern):
        """The match in the next line that has one."""
        for line in self.process.stdout:
            self.said += line
            if found := re.search(pattern, line):
                return found
        raise AssertionError(f"tactree serve has ended without {pattern}: {self.said}")

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        self.said += self.process.stdout.read()
        self.process.stdout.close()
        code = self.process.wait()
        assert code in (0, -signal.SIGKILL), self.said


def subscribe(port, rate_hz, queue=1):
    """A program that has got the first state of its subscription."""
    program = WebSocket(port)
    program.receive()
    program.send({"tactree": {"subscribe": {"rate_hz": rate_hz, "queue": queue}}})
    while program.receive()["tactree"].get("client", {}).get("every_ticks", 0) == 0:
        pass
    return program
