"""Tables of docs/SAFETY.md: states and limits from the headers of core, the failures of other projects with the tests
that exclude them, and a campaign that injects faults into all parts of a simulated device.
"""
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile

SECONDS = 3.0
TIMES = 12  # injections of each fault in each situation

# Injection, and the fault that must be reported; None: no fault is required, only the limit of the force.
FAULTS = [
    ("encoder1:stuck", None),
    ("encoder3:stuck", None),
    ("encoder2:disconnected", "encoder-invalid"),
    ("encoder3:jump=600", "encoder-jump"),
    ("motor3:dead", None),
    ("motor3:stuck", None),
    ("motor3:reversed", None),
    ("motor:weak=0.2", None),
    ("motor:failure", "motor-fault"),
    ("estop:pressed", "emergency-stop"),
    ("deadman:released", None),
    ("enable:off", "enable-mismatch"),
    ("link:dead", None),
    ("link:arm", None),
    ("supply:sag=12", "supply"),
    ("loop:overrun=3", "deadline-missed"),
    ("clock:drift=20000", None),
]

# Failures of other projects, and the tests that exclude them here: Suite.Name.
FIELD = [
    ("the library does not limit the force", "chai3d #2",
     "SafetyGate.KeepsLimitsForRandomBits"),
    ("a spike of one tick causes a force spike", "irFFB #7", "AnyInput.KeepsLimitsUnderWildMotion"),
    ("the device jumps when the emergency stop is released", "ubiquity_motor #58",
     "Faults.KeepsPressedEmergencyStopLatched"),
    ("the expiry of the watchdog moves a motor", "DynamixelSDK #584",
     "Stm32f405.TriggersWatchdogOnBlockedLoop"),
    ("the motor continues after the cable was unplugged", "DynamixelSDK #14, Betaflight #3340",
     "Faults.StopsOnRequiredLinkLoss"),
    ("the USB stack deadlocks while the loop continues", "ODrive #476",
     "LossyLink.ShutsDownDespiteBlockedDriver"),
    ("the arm command feeds the watchdog", "mrover #464", "Faults.IgnoresArmCommandAsHeartbeat"),
    ("one mode lacks the limit of the others", "mechatronics-firmware PR #25",
     "SafetyGate.KeepsLimitsForUnusualFloats"),
    ("the status reports no fault although a part failed", "ODrive #700",
     "Faults.LatchesImmediatelyInEveryState"),
    ("corrupt storage causes a boot loop", "littlefs #390",
     "BlobOnBoard.IsRefusedWithWrongBit"),
    ("motors move during a reset", "PX4 #7123", "Pin.StartsOutputLow"),
    ("a late message enables the amplifiers again", "haptikfabriken",
     "Arming.IgnoresArmAfterClearedFault"),
    ("NaN passes `if (x < 0)`", "smartknob",
     "Configuration.RefusesNaNInfinityAndNegatives"),
    ("a wrong Jacobian of a delta device", "libnifalcon #66",
     "EveryDevice.JacobianAgreesWithNumericDifferences"),
    ("a breakpoint in the loop causes a force step on resume", "OpenHaptics guide, chapter 10",
     "Faults.LatchesTwoCloseOverruns"),
    ("header sizes are added without overflow check", "MCUboot #2659, #2819",
     "BlobRules.RefusesTruncatedLastSection"),
    ("headers are validated, the structures behind them are not", "NVIDIA/warp #1887, #1895",
     "Corruption.ChecksEveryStructure"),
]

# Motion of the hand and stiffness of the surface.
SITUATIONS = {
    "free": ["--script", "hover"],
    "contact": ["--script", "rub"],
    "full force": ["--script", "press", "--stiffness", "1800", "--hand-stiffness", "4000"],
}


def sheet(file):
    """z = 2.5 mm (cos kx + cos ky), half a millimetre apart, as text."""
    wave = 2.0 * math.pi / 0.06
    with open(file, "w") as out:
        out.write("x,y,z,nx,ny,nz\n")
        for i in range(-80, 81):
            for j in range(-80, 81):
                x, y = i * 5e-4, j * 5e-4
                z = 2.5e-3 * (math.cos(wave * x) + math.cos(wave * y))
                nx, ny = (2.5e-3 * wave * math.sin(wave * v) for v in (x, y))
                size = math.sqrt(nx * nx + ny * ny + 1.0)
                out.write(f"{x:.6f},{y:.6f},{z:.9f},{nx / size:.6f},{ny / size:.6f},{1 / size:.6f}\n")


class Campaign:
    def __init__(self, tool, folder, times):
        self.tool, self.folder, self.times = tool, pathlib.Path(folder), times
        scan = self.folder / "sheet.csv"
        sheet(scan)
        self.blob = self.folder / "sheet.blob"
        subprocess.run([tool, "build", scan, "--spacing", "0.001", "-o", self.blob], check=True, stdout=subprocess.DEVNULL)

    def strike(self, number, what, situation, moment):
        report = self.folder / f"{number}.json"
        done = subprocess.run(
            [self.tool, "simulate", self.blob, "--device", "cartesian", "--seconds", str(SECONDS),
             "--inject", f"{what}@{moment:.3f}s", "--json", report, *SITUATIONS[situation]],
            check=False, capture_output=True, text=True)
        if done.returncode not in (0, 1) or not report.exists():
            raise SystemExit(f"generate: {what} while {situation}: {done.stderr.strip()}")
        result = json.loads(report.read_text())
        report.unlink()
        faults = [f["name"] for f in result["faults"]]
        return {**result["injected"], "fault": faults[0] if faults else None}

    def rows(self):
        moments = [0.4 + (SECONDS - 1.0) * (k + 0.37) / self.times for k in range(self.times)]
        jobs = [(what, fault, situation, moment) for what, fault in FAULTS
                for situation in SITUATIONS for moment in moments]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            strikes = list(pool.map(lambda j: self.strike(j[0], j[1][0], j[1][2], j[1][3]),
                                    enumerate(jobs)))
        rows = []
        for what, fault in FAULTS:
            for situation in SITUATIONS:
                own = [s for j, s in zip(jobs, strikes) if j[0] == what and j[2] == situation]
                seen = [s for s in own if s["detected_s"] is not None]
                rows.append({
                    "what": what, "situation": situation, "promised": fault, "times": len(own),
                    "detected": len(seen), "faults": sorted({s["fault"] for s in seen}),
                    "detected_s": max((s["detected_s"] for s in seen), default=None),
                    "force_max_N": max(s["force_max_N"] for s in own),
                    "moved_m": max(s["moved_m"] for s in own)})
        return rows


def campaign(build):
    with tempfile.TemporaryDirectory() as folder:
        return campaign_table(Campaign(build / "tools/cli/tactree", folder, TIMES).rows())


def campaign_table(rows):
    lines = ["| broken | while | detected as | of | after at most, ms | largest force, N | "
             "moved, mm |", "|---|---|---|---|---|---|---|"]
    for r in rows:
        missed = "no fault: the force ends" if r["what"].startswith("deadman") else "not detected"
        names = ", ".join(f"[{n}](faults/{n}.md)" for n in r["faults"]) or missed
        after = "-" if r["detected_s"] is None else f"{1e3 * r['detected_s']:.0f}"
        lines.append(f"| `{r['what']}` | {r['situation']} | {names} | {r['detected']} / {r['times']} "
                     f"| {after} | {r['force_max_N']:.2f} | {1e3 * r['moved_m']:.1f} |")
    return "\n".join(lines)


def states(root):
    """The transition table of core/, as a table of Markdown."""
    source = (root / "core/include/tactree/core/control/state_machine.hpp").read_text()
    states = re.findall(r"^  k(\w+)(?: = 0)?,  +///<", source.split("enum class Event")[0], re.M)
    events = re.findall(r"^  k(\w+)(?: = 0)?,", source.split("enum class Event")[1], re.M)
    letters = dict(re.findall(r"constexpr State k(\w) = State::k(\w+);", source))
    rows = re.findall(r"^    \{((?:k\w, )+k\w)\}", source, re.M)
    if len(states) != 6 or len(events) != 10 or len(rows) != 6:
        raise SystemExit("generate: state_machine.hpp has an unknown layout (adapt states())")
    words = lambda name: re.sub(r"(?<!^)(?=[A-Z])", "-", name).lower()
    lines = ["| state | " + " | ".join(words(e) for e in events) + " |",
             "|---" * (len(events) + 1) + "|"]
    for state, row in zip(states, rows):
        cells = [letters[c.strip()[1:]] for c in row.split(",")]
        lines.append(f"| **{words(state)}** | " + " | ".join(words(c) for c in cells) + " |")
    return "\n".join(lines)


# The groups of core::Configuration that limit or supervise, and their members of it.
LIMITS = [("ForceLimits", "limits"), ("MotorLimits", "motors"), ("Supervision", "supervision"),
          ("LinkSupervision", "link")]


def limits(root):
    """The table of the limits, from the declarations and their comments."""
    source = (root / "core/include/tactree/core/configuration/configuration.hpp").read_text()
    lines = ["| parameter | default | meaning and range |", "|---|---|---|"]
    for group, member in LIMITS:
        if not re.search(rf"^  {group} {member}{{}};", source, re.M):
            raise SystemExit(f"generate: Configuration has no member {member} of type {group}")
        body = re.search(rf"^struct {group} {{\n(.*?)^}};", source, re.M | re.S).group(1)
        for name, default, text in re.findall(
                r"^  (?:float|bool) (\w+)(?:\[kAxes\])? = ([^;]+);\s*///< ([^\n]+)", body, re.M):
            value = re.sub(r"(?<=\d)F", "", default).strip("{}")
            lines.append(f"| `{member}.{name}` | {value} | {text} |")
    return "\n".join(lines)


def field(root):
    """The table of FIELD; every test must exist."""
    tests = set()
    for source in (root / "tests").rglob("*.cpp"):
        tests |= {f"{a}.{b}" for a, b in
                  re.findall(r"^TEST(?:_[FP])?\((\w+), (\w+)\)", source.read_text(), re.M)}
    lines = ["| failure | project | test |", "|---|---|---|"]
    for what, where, test in FIELD:
        if test not in tests:
            raise SystemExit(f"generate: there is no test {test}")
        lines.append(f"| {what} | {where} | `{test}` |")
    return "\n".join(lines)
