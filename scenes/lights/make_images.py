#!/usr/bin/env python3
"""Makes the images of this folder's scenes: window.png, panes of coloured glass; sky.hdr, a painted
sky; lobes.hdr and downlight.ies, the intensities of two lamps."""

import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def write_png(name, width, height, pixel):
    """An 8-bit RGB image; pixel(u, v) gives three values in 0..255, v growing downwards."""
    rows = b"".join(
        b"\0"
        + bytes(value for x in range(width) for value in pixel((x + 0.5) / width, (y + 0.5) / height))
        for y in range(height)
    )

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(os.path.join(HERE, name), "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def window(u, v):
    """A rose in a grid of panes between leads; the pane at the top left is white."""
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


def equal_area_direction(u, v):
    """From the unit square to the sphere, z up (Clarberg 2008)."""
    u, v = 2 * u - 1, 2 * v - 1
    distance = 1 - (abs(u) + abs(v))
    radius = 1 - abs(distance)
    phi = math.pi / 4 * ((abs(v) - abs(u)) / radius + 1 if radius > 0 else 1)
    scale = radius * math.sqrt(2 - radius * radius)
    x = math.copysign(math.cos(phi), u) * scale
    y = math.copysign(math.sin(phi), v) * scale
    return x, y, math.copysign(1 - radius * radius, distance)


def sky(u, v):
    """Radiance: a low sun before the window (y is away from it), blue above, green below."""
    x, y, z = equal_area_direction(u, v)
    if z < 0:
        return (0.10, 0.16, 0.06)
    t = math.sqrt(z)
    color = [0.75 * (1 - t) + 0.22 * t, 0.80 * (1 - t) + 0.38 * t, 0.85 * (1 - t) + 0.75 * t]
    sun = max(0.0, 0.45 * x - 0.70 * y + 0.55 * z) ** 900
    return tuple(c + s * sun for c, s in zip(color, (480, 400, 280)))


def lobes(u, v):
    """Intensity: four petals around the axis, and a little everywhere."""
    x, y, z = equal_area_direction(u, v)
    around = math.atan2(y, x)
    value = 0.05 + math.cos(2 * around) ** 6 * (1 - z * z) ** 2
    return (value, value, value)


def write_hdr(name, size, pixel):
    """A flat Radiance picture (Ward 1991)."""

    def rgbe(color):
        largest = max(color)
        if largest < 1e-32:
            return bytes(4)
        mantissa, exponent = math.frexp(largest)
        scale = mantissa * 256 / largest
        return bytes([int(c * scale) for c in color] + [exponent + 128])

    with open(os.path.join(HERE, name), "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (size, size))
        for y in range(size):
            for x in range(size):
                file.write(rgbe(pixel((x + 0.5) / size, (y + 0.5) / size)))


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
    write_png("window.png", 192, 192, window)
    write_hdr("sky.hdr", 128, sky)
    write_hdr("lobes.hdr", 64, lobes)
    write_ies("downlight.ies")
