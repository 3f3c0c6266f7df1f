#!/usr/bin/env python3
"""Draws the images of this folder's scenes: window.png, panes of coloured glass."""

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


if __name__ == "__main__":
    write_png("window.png", 192, 192, window)
