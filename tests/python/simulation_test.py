"""tactree.Simulation: each tick is that of tactree simulate.

usage: simulation_test.py TACTREE
"""
import csv
import json
import pathlib
import sys
import unittest

import numpy as np
import tactree

from clouds import ModelFolder, runs_beside, signal_during, tool_error, write_rows

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
SUMMARY = ("ticks", "contact_ticks", "overruns", "force_max_N", "force_step_max_N", "penetration_max_m", "trace_crc32",
           "faults", "crowded_ticks")


class Folder(ModelFolder):
    tool = TACTREE

    def tool_run(self, *options, code=0):
        """Rows of the trace and the summary."""
        done = self.run_tool("simulate", self.blob, "--trace", "tool.csv", "--json", "tool.json", "--allow-no-contact",
                             *options)
        self.assertEqual(done.returncode, code, done.stderr)
        with (self.path / "tool.csv").open() as file:
            return list(csv.DictReader(file)), self.read("tool.json")

    def expect_same(self, simulation, trace, tool):
        rows, summary = tool
        self.assertEqual(len(trace), len(rows))
        self.assertEqual(list(trace.dtype.names), list(rows[0]))
        for name in trace.dtype.names:
            column = [row[name] for row in rows]
            if name == "state":
                self.assertEqual([tactree.STATES[state] for state in trace[name]], column)
            elif trace.dtype[name].kind == "f":  # nine digits identify a float32
                self.assertEqual([f"{float(value):.9g}" for value in trace[name]], column, name)
            else:
                self.assertEqual([int(value) for value in trace[name]], [int(value) for value in column], name)
        # The checksum covers all bits of the forces.
        self.assertEqual(simulation.summary, {name: summary[name] for name in SUMMARY})


class SameAsTheTool(Folder):
    def test_script(self):
        simulation = tactree.Simulation(self.model)
        trace = simulation.run(script="rub", seconds=0.5)
        self.assertEqual(len(trace), 500)
        self.assertTrue(trace["in_contact"].any())
        self.expect_same(simulation, trace, self.tool_run("--seconds", "0.5"))

    def test_pose_is_that_of_tool(self):
        pose = np.eye(4)
        pose[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        pose[:3, 3] = [0.01, 0.0, -0.005]
        (self.path / "pose.json").write_text(json.dumps({"pose": pose.ravel().tolist(), "scale": 0.9}))
        tool = self.tool_run("--seconds", "0.5", "--pose", "pose.json")
        for values in ({"pose": self.path / "pose.json"}, {"pose": pose, "scale": 0.9}):
            simulation = tactree.Simulation(self.model, **values)
            trace = simulation.run(script="rub", seconds=0.5)
            self.assertTrue(trace["in_contact"].any())
            self.expect_same(simulation, trace, tool)
        for values, cause in (({"pose": 2 * pose}, "rotation"), ({"pose": pose[:3]}, "16 numbers"),
                              ({"pose": pose, "origin_m": (0, 0, 0)}, "both place"),
                              ({"scale": 2}, "belongs to the matrix")):
            with self.assertRaisesRegex(tactree.Error, cause):
                tactree.Simulation(self.model, **values)

    def test_options_have_effect_of_tool(self):
        for values, options in (
                ({"device": "falcon"}, ["--device", "falcon"]), ({"rate_hz": 2000}, ["--rate", "2000"]),
                ({"mode": "paper"}, ["--mode", "paper"]), ({"stiffness_N_m": 300}, ["--stiffness", "300"]),
                ({"damping_Ns_m": 1}, ["--damping", "1"]), ({"passivity_Ns_m": 0}, ["--passivity", "0"]),
                ({"static_friction": 0.5, "dynamic_friction": 0.4}, ["--static-friction", "0.5", "--dynamic-friction", "0.4"]),
                ({"texture_height_m": 2e-4, "texture_wavelength_m": 3e-3},
                 ["--texture-height", "2e-4", "--texture-wavelength", "3e-3"]),
                ({"use_materials": False}, ["--no-materials"]), ({"force_max_N": 2}, ["--force-max", "2"]),
                ({"first_force": True}, ["--first-force"]),
                ({"origin_m": [0, 0, 0.002]}, ["--origin", "0", "0", "0.002"]), ({"latency_ticks": 1}, ["--latency-ticks", "1"]),
                ({"device": "cartesian", "encoder_step_m": 1e-5, "device_mass_kg": 0.2, "device_friction_N": 0.1},
                 ["--device", "cartesian", "--encoder-step", "1e-5", "--device-mass", "0.2", "--device-friction", "0.1"]),
                ({"hand_stiffness_N_m": 200, "hand_damping_Ns_m": 3, "hand_mass_kg": 0.2},
                 ["--hand-stiffness", "200", "--hand-damping", "3", "--hand-mass", "0.2"])):
            with self.subTest(options=options):
                simulation = tactree.Simulation(self.model, **values)
                trace = simulation.run(seconds=0.1, script="press")
                self.expect_same(simulation, trace, self.tool_run("--seconds", "0.1", "--script", "press", *options))

    def test_accepts_device_file(self):
        self.write("mine.json", self.run_tool("simulate", "--device", "falcon", "--dump-device").stdout)
        simulation = tactree.Simulation(self.model, device=str(self.path / "mine.json"))
        trace = simulation.run(seconds=0.1)
        self.expect_same(simulation, trace, self.tool_run("--seconds", "0.1", "--device", self.path / "mine.json"))

    def test_timed_path(self):
        path = [[0, 0, 0, 0.04], [0.1, 0, 0, 0.028], [0.3, 0.01, 0, 0.027]]
        write_rows(self.path / "path.csv", "t_s,x,y,z", path)
        simulation = tactree.Simulation(self.model)
        trace = simulation.run(path)
        self.assertTrue(trace["in_contact"].any())
        self.expect_same(simulation, trace, self.tool_run("--path", "path.csv", "--seconds", "0.3"))

    def test_returns_row_per_tick(self):
        heights = np.linspace(0.04, 0.027, 200)
        path = np.stack([0 * heights, 0 * heights, heights], axis=1)
        write_rows(self.path / "rows.csv", "t_s,x,y,z", np.hstack([np.arange(200)[:, None] / 1000, path]))
        simulation = tactree.Simulation(self.model)
        self.expect_same(simulation, simulation.run(path), self.tool_run("--path", "rows.csv", "--seconds", "0.2"))

    def test_injected_faults(self):
        fault = "encoder1:disconnected@0.05s"
        simulation = tactree.Simulation(self.model, faults=[fault])
        trace = simulation.run(seconds=0.1)
        self.assertEqual(simulation.state, "fault")
        self.assertIn("encoder", " ".join(tactree.fault_names(trace["faults"][-1])))
        self.expect_same(simulation, trace, self.tool_run("--seconds", "0.1", "--inject", fault, code=1))


class Steps(Folder):
    def test_steps_press_on_surface(self):
        simulation = tactree.Simulation(self.model)
        for _ in range(300):
            tick = simulation.step([0, 0, 0.04])
        self.assertFalse(tick.in_contact)
        self.assertEqual(tick.state, "active")
        for _ in range(300):
            tick = simulation.step((0, 0, 0.026))
        self.assertTrue(tick.in_contact)
        self.assertGreater(tick.force_N[2], 0.1)
        np.testing.assert_allclose(tick.normal, [0, 0, 1], atol=0.05)
        self.assertAlmostEqual(float(tick.proxy_m[2]), 0.03, places=3)
        self.assertLess(tick.position_m[2], tick.proxy_m[2])
        np.testing.assert_allclose(tick.tip_m, tick.position_m, atol=2e-4)
        self.assertGreater(tick.penetration_m, 0)
        self.assertEqual((tick.faults, tick.limits), (0, 0))
        self.assertAlmostEqual(simulation.time_s, 0.6)
        self.assertAlmostEqual(tick.time_s, 0.599)

    def test_run_continues_in_parts(self):
        whole, parts = tactree.Simulation(self.model), tactree.Simulation(self.model)
        rest = np.tile([0, 0, 0.0285], (50, 1))
        trace = whole.run(np.tile([0.0, 0, 0.035], (50, 1)))
        np.testing.assert_array_equal(trace, parts.run(np.tile([0.0, 0, 0.035], (50, 1))))
        trace = whole.run(rest)
        forces = [parts.step(position).force_N for position in rest]
        np.testing.assert_array_equal(tactree.vectors(trace, "force"), np.array(forces, np.float32))
        self.assertEqual(whole.summary, parts.summary)
        self.assertEqual(whole.summary["ticks"], 100)
        whole.reset()
        self.assertEqual(whole.time_s, 0)
        self.assertEqual(len(whole.run(rest + [0, 0, 0.01])), 50)
        self.assertEqual(whole.summary["ticks"], 50)

    def test_encoders_move_probe(self):
        simulation = tactree.Simulation(self.model, device="cartesian", encoder_step_m=1e-5)
        # Home is the origin of the device, which is the centre of the ball; counts are of 10 um.
        for _ in range(100):
            tick = simulation.step(encoders=[0, 0, 4000])
        np.testing.assert_allclose(tick.position_m, [0, 0, 0.04], atol=1e-4)
        np.testing.assert_array_equal(tick.tip_m, tick.position_m)
        self.assertFalse(tick.in_contact)
        for count in range(4000, 2950, -10):  # 0.1 m/s
            tick = simulation.step(encoders=[0, 0, count])
        self.assertTrue(tick.in_contact)
        self.assertGreater(tick.force_N[2], 0.1)

    def test_stop_clear_and_arm(self):
        simulation = tactree.Simulation(self.model)
        away = [0, 0, 0.04]
        simulation.step(away)
        simulation.stop()
        self.assertEqual(simulation.step(away).state, "idle")
        simulation.arm()
        self.assertEqual(simulation.step(away).state, "armed")

    def test_other_threads_run_meanwhile(self):
        simulation = tactree.Simulation(self.model)
        self.assertTrue(runs_beside(lambda: simulation.run(seconds=5)))

    def test_ctrl_c_ends_run(self):
        simulation = tactree.Simulation(self.model)
        with self.assertRaises(KeyboardInterrupt), signal_during("run"):
            simulation.run(seconds=100)
        self.assertLess(simulation.time_s, 100)
        self.assertEqual(simulation.step([0, 0, 0.04]).state, "active")  # it can go on


class Refusals(Folder):
    def test_errors_equal_tool(self):
        self.run_tool("build", "ball.csv", "-o", "stiff.blob", "--material", "stiffness=90000")
        for blob, values, options in (
                (self.blob, {"stiffness_N_m": 90000}, ["--stiffness", "90000"]),
                (self.blob, {"device": "no-such-device"}, ["--device", "no-such-device"]),
                (self.path / "stiff.blob", {}, [])):
            run = self.run_tool("simulate", blob, "--seconds", "0.01", *options)
            self.assertEqual(run.returncode, 1)
            with self.assertRaises(tactree.Error) as refused:
                tactree.Simulation(tactree.load(blob), **values)
            self.assertEqual(str(refused.exception), tool_error(run).splitlines()[-1].removeprefix("tactree: error: "))

    def test_refuses_hand_inside_object(self):
        write_rows(self.path / "inside.csv", "t_s,x,y,z", [[0, 0, 0, 0]])
        run = self.run_tool("simulate", self.blob, "--path", "inside.csv", "--seconds", "0.01")
        with self.assertRaises(tactree.Error) as refused:
            tactree.Simulation(self.model).step([0, 0, 0])
        self.assertEqual(str(refused.exception), tool_error(run))

    def test_arguments(self):
        simulation = tactree.Simulation(self.model)
        for call, words in (
                (lambda: simulation.step(), "needs either hand_position or encoders"),
                (lambda: simulation.step([0, 0, 1], encoders=[0, 0, 0]), "needs either"),
                (lambda: simulation.step("left"), "hand_position: 'left' is not an array of numbers"),
                (lambda: simulation.step([0, 0, 1], hand_velocity=["x"]), "hand_velocity: is not an array of numbers"),
                (lambda: simulation.step(encoders=[[0], [0, 0]]), "encoders: is not an array of numbers"),
                (lambda: simulation.run("path.csv"), "path: 'path.csv' is not an array of numbers"),
                (lambda: tactree.Simulation("x.blob"), "Simulation: 'x.blob' is not a Model (load() reads a blob"),
                (lambda: tactree.Simulation(self.model, pose=[["x"]]), "pose: is not an array of numbers"),
                (lambda: self.model.query("here"), "positions: 'here' is not an array of numbers"),
                (lambda: self.model.nearest("here"), "positions: 'here' is not an array of numbers"),
                (lambda: simulation.step([[0, 0, 1], [0, 0, 1]]), "hand_position: is not one position"),
                (lambda: simulation.run([[0, 0]]), "path: the shape (1, 2) is not (N, 3)"),
                (lambda: simulation.run(np.empty((0, 3))), "needs at least one waypoint"),
                (lambda: simulation.run([[1, 0, 0, 0], [1, 0, 0, 0]]), "does not ascend"),
                (lambda: simulation.run(seconds=1e9), "seconds: 1e+12 ticks are outside"),
                (lambda: simulation.run(script="sing"), "sing"),
                (lambda: tactree.Simulation(self.model, mode="loud"), "mode: 'loud' is unknown"),
                (lambda: tactree.Simulation(self.model, rate_hz=1e9), "rate"),
                (lambda: tactree.Simulation(self.model, origin_m=[0, 0]), "origin_m: is not three numbers"),
                (lambda: tactree.Simulation(self.model, latency_ticks=-1), "latency_ticks: is out of range"),
                (lambda: tactree.Simulation(self.model, hand_mass_kg=-1), "mass"),
                (lambda: tactree.Simulation(self.model, faults=["encoder9:x"]), "encoder9")):
            with self.subTest(words=words), self.assertRaises(tactree.Error) as refused:
                call()
            self.assertIn(words, str(refused.exception))


if __name__ == "__main__":
    unittest.main(verbosity=2)
