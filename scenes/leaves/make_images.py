#!/usr/bin/env python3
"""Draws leaf.png (RGBA: a leaf and what is around it) and fence.png (gray: a wire mesh), and places
leaves along a branch: branch.inc."""

import math
import os
import random
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from images import write_png  # noqa: E402

SIZE = 128


def leaf(x, y):
    """A pointed leaf along v with a serrated edge, veins and a stalk."""
    u, v = (x + 0.5) / SIZE - 0.5, 1 - (y + 0.5) / SIZE
    blade = (v - 0.15) / 0.83
    inside = False
    if 0 < blade < 1:
        teeth = 0.012 * abs((blade * 14) % 1 - 0.5)
        half_width = 0.40 * math.sin(math.pi * blade**0.75) ** 1.1 - teeth
        inside = abs(u) < half_width
    stalk = abs(u) < 0.014 and v < 0.3
    vein = abs(u) < 0.01 or abs((blade * 9 - abs(u) * 9) % 1 - 0.5) < 0.06
    shade = 1.0 if vein or stalk else 0.72 + 0.1 * math.sin(40 * u) * math.sin(31 * v)
    color = [0.42 * shade, 0.62 * shade, 0.18 * shade]
    # The edge is softened over two pixels by the texture's own interpolation.
    return color + [1.0 if inside or stalk else 0.0]


def fence(x, y):
    """Two sets of wires, a cell of a mesh that repeats."""
    u, v = (x + 0.5) / SIZE, (y + 0.5) / SIZE

    def wire(t):
        return abs((t + 0.5) % 1 - 0.5) < 0.055

    return [1.0 if wire(u + v) or wire(u - v) else 0.0]


def branch():
    """Leaves as instances, in pairs along a line with some disorder."""
    places = random.Random(7)
    lines = ["# Made by make_images.py.\n"]
    for i in range(26):
        along = -2.2 + 4.4 * i / 25
        side = 1 if i % 2 else -1
        droop = 1.95 + 0.16 * math.cos(along * 1.3)
        lines.append(
            "AttributeBegin Translate %.3f %.3f %.3f Rotate %.1f 0 1 0 Rotate %.1f 1 0 0 "
            "Rotate %.1f 0 0 1 Scale %.2f %.2f %.2f ObjectInstance \"leaf\" AttributeEnd\n"
            % (
                (along, droop, 0.1 * side)
                + (places.uniform(-50, 50), places.uniform(-40, 50), side * places.uniform(110, 175))
                + (places.uniform(0.5, 0.75),) * 3
            )
        )
    with open(os.path.join(HERE, "branch.inc"), "w") as file:
        file.writelines(lines)


if __name__ == "__main__":
    write_png(os.path.join(HERE, "leaf.png"), SIZE, SIZE, 4, leaf)
    write_png(os.path.join(HERE, "fence.png"), SIZE, SIZE, 1, fence)
    branch()
