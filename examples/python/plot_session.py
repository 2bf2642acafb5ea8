#!/usr/bin/python3
"""Simulates a hand that touches a model, and plots force and depth over time.

usage: plot_session.py MODEL.blob [--device NAME] [--script NAME] [--seconds S] [--plot FILE] [--trace FILE.npy]
"""
import argparse
import sys

import numpy as np
import tactree


def plot(trace, title, file):
    """Writes a picture; returns False if matplotlib is not installed."""
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("Agg")  # needs no display
    from matplotlib import pyplot
    figure, (force, depth) = pyplot.subplots(2, 1, sharex=True, figsize=(8, 5), constrained_layout=True)
    for axis, values in zip("xyz", tactree.vectors(trace, "force").T):
        force.plot(trace["t_s"], values, linewidth=0.8, label=axis)
    force.set(title=title, ylabel="force, N")
    force.legend()
    depth.fill_between(trace["t_s"], 1e3 * trace["penetration_m"])
    depth.set(xlabel="time, s", ylabel="depth, mm")
    figure.savefig(file)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", help="blob of tactree build")
    parser.add_argument("--device", default="premium", help=", ".join(tactree.device_names()) + ", or a device file")
    parser.add_argument("--script", default="rub", choices=tactree.scripts(), help="motion of the hand")
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--plot", default="session.png", help="picture to write: PNG, SVG or PDF")
    parser.add_argument("--trace", help="also write every tick to this file, for numpy.load()")
    options = parser.parse_args()

    model = tactree.load(options.model)
    simulation = tactree.Simulation(model, device=options.device)
    trace = simulation.run(script=options.script, seconds=options.seconds)
    largest = np.linalg.norm(tactree.vectors(trace, "force"), axis=1).max()
    contact_ms = 1e3 * trace["in_contact"].sum() / simulation.rate_hz
    print(f"in contact for {contact_ms:.0f} of {1e3 * options.seconds:.0f} ms, largest force {largest:.3f} N")
    if options.trace:
        np.save(options.trace, trace)
    if not plot(trace, f"{model.name}, {options.device}", options.plot):
        print("no plot: matplotlib is missing (apt-get install python3-matplotlib)", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except tactree.Error as error:
        sys.exit(f"plot_session: {error}")
