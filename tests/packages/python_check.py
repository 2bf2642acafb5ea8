"""The installed Python package answers as the installed program, to the last digit that this prints.

usage: python_check.py BLOB
"""
import csv
import subprocess
import sys

import numpy as np
import tactree

blob = sys.argv[1]
model = tactree.load(blob)
# On the surface, 1 mm around it, and far away.
near = model.points[::500]
positions = np.vstack([near, near + 0.001 * model.normals[::500], near - 0.001 * model.normals[::500], [[1, 1, 1]]])
with open("positions.csv", "w", encoding="utf-8") as file:
    file.write("x,y,z\n")
    file.writelines(",".join(f"{float(value):.9g}" for value in row) + "\n" for row in positions)
printed = subprocess.run(["tactree", "query", blob, "--points", "positions.csv"], capture_output=True, text=True, check=True)
rows = list(csv.DictReader(printed.stdout.splitlines()))
answers = model.query(positions)
assert len(rows) == len(answers) == 3 * len(near) + 1, (len(rows), len(answers))
for row, answer in zip(rows, answers):
    for name in ("distance_m", "surface_x", "normal_z", "signed_distance_m"):
        text = "" if np.isnan(answer[name]) else f"{float(answer[name]):.9g}"
        assert row[name] == text, (name, row, answer)
assert {row["inside"] for row in rows} == {"0", "1"}, "positions on both sides"

simulation = tactree.Simulation(model)
trace = simulation.run(script="rub", seconds=0.5)
assert trace["in_contact"].any() and not simulation.summary["faults"]
print(f"{len(rows)} answers are equal; {len(trace)} ticks simulated")
