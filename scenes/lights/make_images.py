#!/usr/bin/env python3
"""Makes the images of this folder's scenes: window.png, panes of coloured glass; sky.hdr, a painted
sky; landscape.hdr, hills around a meadow; lobes.hdr and downlight.ies, the intensities of two lamps."""

import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from images import clear_sky, equal_area_direction, write_hdr, write_png  # noqa: E402

WINDOW_SIZE = 192


def window(u, v):
    """A rose in a grid of panes between leads; the pane at the top left is white; in 0..255."""
    lead = (8, 8, 8)
    x, y = u - 0.5, v - 0.5
    radius, angle = math.hypot(x, y), math.atan2(y, x)
    if radius < 0.36:
        ring, petal = int(radius * 12.5), angle / (2 * math.pi) * 12
        if abs(radius * 12.5 - round(radius * 12.5)) < 0.07 or radius > 0.352:
            return lead
        if ring > 0 and abs(petal - round(petal)) * radius < 0.012:
            return lead
        petals = [(250, 215, 90), (230, 60, 40), (60, 90, 220), (230, 150, 40)]
        return petals[(ring + int(math.floor(petal)) % 2 * 2) % 4] if ring else petals[0]
    column, row = int(u * 6), int(v * 6)
    if abs(u * 6 - round(u * 6)) < 0.05 or abs(v * 6 - round(v * 6)) < 0.05:
        return lead
    if column == 0 and row == 0:
        return (250, 250, 250)
    return [(40, 140, 90), (70, 170, 210), (150, 60, 150)][(column + 2 * row) % 3]


def sky(u, v):
    """Radiance: a low sun before the window (y is away from it), blue above, green below."""
    x, y, z = equal_area_direction(u, v)
    if z < 0:
        return (0.10, 0.16, 0.06)
    color = clear_sky(z)
    sun = max(0.0, 0.45 * x - 0.70 * y + 0.55 * z) ** 900
    return tuple(c + s * sun for c, s in zip(color, (480, 400, 280)))


def landscape(u, v):
    """Radiance by longitude and latitude: hills, a red barn amid the picture, a pond to its right, the sun
    high to its left."""
    longitude, latitude = 2 * math.pi * u, math.pi * (0.5 - v)
    z = math.sin(latitude)
    east, aside = longitude - math.pi, abs(longitude - math.pi)  # of the picture's middle
    near = 0.05 + 0.03 * math.sin(5 * longitude) + 0.015 * math.sin(11 * longitude + 1)
    far = 0.12 + 0.06 * math.sin(3 * longitude + 2) + 0.03 * math.sin(7 * longitude)
    if aside < 0.1 and -0.02 < latitude < 0.1 + 0.6 * (0.1 - aside):
        return (0.30, 0.05, 0.035)
    if (east - 0.7) ** 2 / 0.16 + (latitude + 0.14) ** 2 / 0.0025 < 1:
        return (0.30, 0.40, 0.52)
    if latitude < near:
        return (0.13, 0.20, 0.05) if latitude < 0 else (0.07, 0.13, 0.04)
    if latitude < far:
        return (0.16, 0.21, 0.27)
    toward = math.cos(latitude) * math.cos(longitude - 0.30 * 2 * math.pi) * math.cos(0.5)
    sun = max(0.0, toward + z * math.sin(0.5)) ** 1200
    return tuple(c + s * sun for c, s in zip(clear_sky(z), (520, 430, 300)))


def smooth_landscape(u, v):
    """The mean over a pixel of 256x128."""
    steps = (-0.375, -0.125, 0.125, 0.375)
    colors = [landscape(u + i / 256, v + j / 128) for i in steps for j in steps]
    return tuple(sum(channel) / len(colors) for channel in zip(*colors))


def lobes(u, v):
    """Intensity: four petals around the axis, and a little everywhere."""
    x, y, z = equal_area_direction(u, v)
    around = math.atan2(y, x)
    value = 0.05 + math.cos(2 * around) ** 6 * (1 - z * z) ** 2
    return (value, value, value)


def write_ies(name):
    """An IES file (LM-63): a bright spot straight down, and a ring at 55 degrees."""
    angles = [2.5 * i for i in range(37)]
    candelas = [
        900 * math.exp(-((a / 14) ** 2)) + 350 * math.exp(-(((a - 55) / 5) ** 2)) for a in angles
    ]

    def rows(values):
        lines = [values[i : i + 10] for i in range(0, len(values), 10)]
        return "".join(" ".join("%g" % round(value, 1) for value in line) + "\n" for line in lines)

    with open(os.path.join(HERE, name), "w") as file:
        file.write("IESNA:LM-63-1995\n[TEST] drawn, not measured\nTILT=NONE\n")
        file.write("1 -1 1 %d 1 1 2 0.1 0.1 0\n1 1 10\n" % len(angles))
        file.write(rows(angles) + "0\n" + rows(candelas))


if __name__ == "__main__":
    write_png(
        os.path.join(HERE, "window.png"), WINDOW_SIZE, WINDOW_SIZE, 3,
        lambda x, y: [c / 255 for c in window((x + 0.5) / WINDOW_SIZE, (y + 0.5) / WINDOW_SIZE)],
    )
    write_hdr(os.path.join(HERE, "sky.hdr"), 128, sky)
    write_hdr(os.path.join(HERE, "landscape.hdr"), 128, smooth_landscape, 256)
    write_hdr(os.path.join(HERE, "lobes.hdr"), 64, lobes)
    write_ies("downlight.ies")
