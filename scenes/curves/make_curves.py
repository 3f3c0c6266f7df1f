#!/usr/bin/env python3
"""Writes hair.inc, a ball's 5,000 hairs, and grass.inc, 600 blades, beside this file."""
import math
import pathlib
import random

random.seed(7)
here = pathlib.Path(__file__).parent


def text(points):
    return "  ".join(" ".join(f"{x:.3f}" for x in p) for p in points)


def around():
    """A direction, even over the sphere."""
    z, phi = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return r * math.cos(phi), z, r * math.sin(phi)


with open(here / "hair.inc", "w") as hair:
    hair.write('Attribute "shape" "string type" "cylinder" "float width0" 0.012 "float width1" 0.003\n')
    for _ in range(5000):
        d = around()
        if d[1] < -0.75:
            continue
        length = random.uniform(0.35, 0.5)
        curl = [random.gauss(0, 0.05) for _ in range(6)]
        points = []
        for i in range(4):
            t = i / 3
            r = 0.6 + length * t
            bend = curl[:3] if i < 3 else curl[3:]
            # Hairs hang by their own weight.
            points.append((d[0] * r + bend[0] * t, d[1] * r + bend[1] * t - 0.28 * t * t,
                           d[2] * r + bend[2] * t))
        hair.write(f'Shape "curve" "point3 P" [ {text(points)} ]\n')

with open(here / "grass.inc", "w") as grass:
    grass.write('Attribute "shape" "string type" "ribbon" "integer degree" 2 "float width0" 0.035 '
                '"float width1" 0.004\n')
    for _ in range(600):
        x, z = random.uniform(-2.2, 3.4), random.uniform(-1.2, 2.5)
        height, lean, phi = random.uniform(0.25, 0.55), random.uniform(0.05, 0.25), random.uniform(0, 6.283)
        c, s = math.cos(phi) * lean, math.sin(phi) * lean
        points = [(x, 0, z), (x, height / 2, z), (x + c, height, z + s)]
        n = [(-math.cos(phi), 0, -math.sin(phi)), (-math.cos(phi) * 0.7, 0.7, -math.sin(phi) * 0.7)]
        grass.write(f'Shape "curve" "point3 P" [ {text(points)} ] "normal N" [ {text(n)} ]\n')
