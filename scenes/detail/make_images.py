#!/usr/bin/env python3
"""Draws the images of detail.pbrt: bricks as heights and as the normals of the same surface, and the
dents of a hammer."""

import math
import os
import random
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from images import write_png  # noqa: E402

SIZE = 256
HEIGHT = 0.06  # Of a brick over the mortar, where the wall is 2 units wide and high.
WALL = 2.0


def smooth(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * (3 - 2 * x)


def brick(u, v):
    """Height in 0..1 of a wall of 4 by 8 bricks; v grows upwards."""
    row = math.floor(v * 8)
    x, y = (u * 4 + 0.5 * (row % 2)) % 1, v * 8 % 1
    edge = min(min(x, 1 - x) * 2, min(y, 1 - y))
    swell = 0.12 * math.sin(math.pi * x) * math.sin(math.pi * y)
    return 0.88 * smooth((edge - 0.06) / 0.14) + swell


def wall(x, y):
    return brick((x + 0.5) / SIZE, 1 - (y + 0.5) / SIZE)


def brick_normal(x, y):
    """By differences of the heights in the wall's units, as an RGB code of the unit normal."""
    step = WALL / SIZE
    n = [
        HEIGHT * (wall(x - 1, y) - wall(x + 1, y)) / (2 * step),
        HEIGHT * (wall(x, y + 1) - wall(x, y - 1)) / (2 * step),
        1.0,
    ]
    length = math.sqrt(sum(c * c for c in n))
    return [0.5 + 0.5 * c / length for c in n]


def dents():
    """Round dents that repeat at the edges."""
    places = random.Random(4)
    marks = [(places.random(), places.random(), 0.05 + 0.06 * places.random()) for _ in range(160)]

    def height(x, y):
        u, v = (x + 0.5) / SIZE, (y + 0.5) / SIZE
        lowest = 1.0
        for cu, cv, radius in marks:
            du, dv = (u - cu + 0.5) % 1 - 0.5, (v - cv + 0.5) % 1 - 0.5
            r2 = (du * du + dv * dv) / (radius * radius)
            if r2 < 1:
                lowest = min(lowest, 1 - (1 - r2) ** 2 * radius / 0.11)
        return [lowest]

    return height


if __name__ == "__main__":
    # Sixteen bits: slopes are differences of near heights.
    write_png(os.path.join(HERE, "brick-heights.png"), SIZE, SIZE, 1, lambda x, y: [wall(x, y)], 16)
    write_png(os.path.join(HERE, "brick-normals.png"), SIZE, SIZE, 3, brick_normal)
    write_png(os.path.join(HERE, "dents.png"), SIZE, SIZE, 1, dents(), 16)
