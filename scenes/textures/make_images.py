#!/usr/bin/env python3
"""Draws the images of textures.pbrt: card.png, a test card, and sky.hdr, a painted sky."""

import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def write_png(name, size, pixel):
    """An 8-bit RGB image; pixel(x, y) gives three values in 0..255, y growing downwards."""
    rows = b"".join(
        b"\0" + bytes(value for x in range(size) for value in pixel(x, y)) for y in range(size)
    )

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    with open(os.path.join(HERE, name), "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def card(x, y):
    """Coloured bands, a ring, and a corner of its own so that a flip is seen."""
    size = 128
    u, v = (x + 0.5) / size, (y + 0.5) / size
    ring = abs(math.hypot(u - 0.5, v - 0.5) - 0.3) < 0.04
    if ring:
        return (235, 235, 225)
    if u < 0.2 and v < 0.2:
        return (190, 40, 35)
    bands = [(52, 76, 110), (220, 160, 60), (60, 130, 110), (200, 195, 180)]
    return bands[int(v * 8) % 4] if int(u * 8) % 2 else bands[(int(v * 8) + 2) % 4]


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
    """Radiance: brighter towards the horizon, a soft sun, brown ground."""
    x, y, z = equal_area_direction(u, v)
    if z < 0:
        return (0.12, 0.10, 0.08)
    t = math.sqrt(z)
    color = [0.75 * (1 - t) + 0.22 * t, 0.80 * (1 - t) + 0.38 * t, 0.85 * (1 - t) + 0.75 * t]
    sun = max(0.0, 0.5 * x + 0.6 * y + 0.62 * z) ** 60
    return tuple(c + s * sun for c, s in zip(color, (30, 26, 20)))


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


if __name__ == "__main__":
    write_png("card.png", 128, card)
    write_hdr("sky.hdr", 64, sky)
