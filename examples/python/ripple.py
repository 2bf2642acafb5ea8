"""Prints a scan to try: a rippled ring of 60 mm, 60 000 points with normals, as PLY.

usage: python3 ripple.py >ripple.ply
"""
import math

POINTS = 60_000
RING, TUBE, RIPPLE, WAVES = 0.022, 0.008, 0.0006, 24  # m, m, m, around the ring


def point(u, v):
    """A place of the surface: u around the ring, v around the tube."""
    tube = TUBE + RIPPLE * math.cos(WAVES * u)
    out = RING + tube * math.cos(v)
    return out * math.cos(u), out * math.sin(u), tube * math.sin(v)


def normal(u, v):
    """The cross product of the tangents."""
    step = 1e-6
    along = [(b - a) / (2 * step) for a, b in zip(point(u - step, v), point(u + step, v))]
    around = [(b - a) / (2 * step) for a, b in zip(point(u, v - step), point(u, v + step))]
    cross = (along[1] * around[2] - along[2] * around[1], along[2] * around[0] - along[0] * around[2],
             along[0] * around[1] - along[1] * around[0])
    length = math.hypot(*cross)
    return [c / length for c in cross]


print("ply\nformat ascii 1.0\ncomment unit m\nelement vertex", POINTS)
for name in ("x", "y", "z", "nx", "ny", "nz"):
    print("property float", name)
print("end_header")
for i in range(POINTS):
    # The golden ratio spreads the points evenly.
    place = 2 * math.pi * i / POINTS, 2 * math.pi * (i * (math.sqrt(5) - 1) / 2 % 1)
    print(*(f"{value:.7g}" for value in (*point(*place), *normal(*place))))
