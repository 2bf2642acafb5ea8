"""A collection that Slurm, Open MPI or GNU parallel distributes gives the bytes of one process, also after a kill.

usage: engines_test.py TACTREE

All programs run on this machine, Slurm with a configuration, ports and state of its own in a temporary folder.
"""
import contextlib
import getpass
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, sphere  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
OBJECTS = 24
PARTS = 4
LARGE = 9  # its build takes seconds. It is the third object of part 2
KILLED_PART, BEFORE_LARGE = 2, 5
LIMIT_S = 300
LAUNCHERS = ("SLURM", "OMPI_", "PMI_")
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith(LAUNCHERS)}


def wait_for(condition, what):
    end = time.monotonic() + LIMIT_S
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {LIMIT_S} s")
        time.sleep(0.02)


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


class Engines(SharedFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.path / "scans").mkdir()
        for i in range(OBJECTS):
            cls.write(f"scans/o{i:02}.xyz", sphere(300000 if i == LARGE else 1000 + 50 * i, 0.03 + 0.001 * i))
        cls.command = [str(TACTREE), "build", "--collection", "scans", "--threads", "1", "--progress", "off"]
        cls.run_command([*cls.command, "-o", "one"])
        cls.reference = cls.results("one")
        assert len(cls.reference) == 2 * OBJECTS, sorted(cls.reference)

    @classmethod
    def run_command(cls, arguments, **options):
        done = subprocess.run(arguments, cwd=cls.path, env={**ENVIRONMENT, **options}, capture_output=True, text=True,
                              check=False, timeout=LIMIT_S)
        assert done.returncode == 0, f"{arguments}\n{done.stdout}{done.stderr}"
        return done.stdout

    @classmethod
    def results(cls, output):
        return {file.name: file.read_bytes() for file in (cls.path / output).iterdir()
                if file.suffix in (".blob", ".png")}

    def row(self, output, number):
        return self.path / output / f"o{number:02}.xyz.json"

    def is_complete(self, output):
        """The results are those of one process; the overview is written."""
        printed = self.run_command([*self.command, "-o", output, "--collect"])
        self.assertIn(f"objects   {OBJECTS}, ", printed)
        self.assertEqual(self.results(output), self.reference)
        self.assertTrue((self.path / output / "index.html").is_file())

    def is_cut_off(self, output):
        """The killed part has its first objects, but not the large one and those behind it."""
        self.assertTrue(self.row(output, BEFORE_LARGE).exists())
        for number in range(LARGE, OBJECTS, PARTS):
            self.assertFalse(self.row(output, number).exists(), number)
        return self.row(output, BEFORE_LARGE).stat().st_ino

    def test_open_mpi(self):
        printed = self.run_command(["mpirun", "--allow-run-as-root", "--oversubscribe", "-np", str(PARTS), *self.command,
                                    "-o", "mpi"])
        for part in range(PARTS):
            self.assertIn(f"part      {part + 1}/{PARTS} (OMPI_COMM_WORLD_RANK={part}, OMPI_COMM_WORLD_SIZE={PARTS}): "
                          f"{OBJECTS // PARTS} of {OBJECTS} objects", printed)
        self.is_complete("mpi")

    def test_gnu_parallel_after_kill(self):
        arguments = ["parallel", "--will-cite", "--jobs", str(PARTS), *self.command, "-o", "parallel",
                     "--part", f"{{}}/{PARTS}", ":::", *map(str, range(1, PARTS + 1))]
        with subprocess.Popen([*self.command, "-o", "parallel", "--part", f"{KILLED_PART}/{PARTS}"], cwd=self.path,
                              env=ENVIRONMENT, stdout=subprocess.DEVNULL) as worker:
            wait_for(self.row("parallel", BEFORE_LARGE).exists, "the object before the large one")
            worker.kill()
        before = self.is_cut_off("parallel")
        self.run_command(arguments)
        self.assertEqual(self.row("parallel", BEFORE_LARGE).stat().st_ino, before)
        self.is_complete("parallel")

    def start_slurm(self):
        """Returns the variable that leads the commands of Slurm to this controller."""
        folder = self.path / "slurm"
        folder.mkdir()
        host, user = socket.gethostname().split(".")[0], getpass.getuser()
        controller_port, node_port = free_ports(2)
        configuration = folder / "slurm.conf"
        configuration.write_text(f"""\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/none
CredType=cred/none
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
        for name in ("state", "spool"):
            (folder / name).mkdir()
        environment = {**ENVIRONMENT, "SLURM_CONF": str(configuration)}
        for daemon in ("slurmctld", "slurmd"):
            log = self.enterContext(open(folder / f"{daemon}.log", "w", encoding="utf-8"))
            program = shutil.which(daemon, path=f"{os.environ['PATH']}:/usr/sbin")
            self.assertIsNotNone(program, f"{daemon} is missing (scripts/install-deps collections)")
            process = subprocess.Popen([program, "-D", "-f", configuration], env=environment, stdout=log, stderr=log)
            self.addCleanup(process.wait, LIMIT_S)
            self.addCleanup(process.terminate)
        variable = {"SLURM_CONF": str(configuration)}

        def is_idle():
            done = subprocess.run(["sinfo", "--noheader", "--format=%t"], env=environment, capture_output=True, text=True,
                                  check=False)
            return done.stdout.strip() == "idle"

        wait_for(is_idle, "the node of Slurm is idle")
        return variable

    def test_slurm_array_after_kill(self):
        slurm = self.start_slurm()
        job = self.path / "job.sh"
        job.write_text("#!/bin/sh\nexec " + " ".join([*self.command, "-o", "slurm-out"]) + "\n")
        submit = ["sbatch", "--parsable", "--ntasks=1", "--cpus-per-task=1", f"--array=1-{PARTS}", "--output=task-%a.log"]
        number = self.run_command([*submit, str(job)], **slurm).strip()
        wait_for(self.row("slurm-out", BEFORE_LARGE).exists, "the object before the large one")
        self.run_command(["scancel", "--signal=KILL", f"{number}_{KILLED_PART}"], **slurm)
        wait_for(lambda: self.run_command(["squeue", "--noheader"], **slurm) == "", "the array has ended")
        before = self.is_cut_off("slurm-out")
        self.assertIn(f"part      {KILLED_PART}/{PARTS} (SLURM_ARRAY_TASK_ID={KILLED_PART}, SLURM_ARRAY_TASK_COUNT={PARTS})",
                      (self.path / f"task-{KILLED_PART}.log").read_text())
        self.run_command([*submit, "--wait", str(job)], **slurm)
        self.assertEqual(self.row("slurm-out", BEFORE_LARGE).stat().st_ino, before)
        self.is_complete("slurm-out")


if __name__ == "__main__":
    unittest.main(verbosity=2)
