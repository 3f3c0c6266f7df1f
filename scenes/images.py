"""What the scripts that draw the scenes' images have in common: PNG and Radiance files, skies."""

import math
import struct
import zlib


def write_png(path, width, height, channels, pixel, bits=8):
    """pixel(x, y) gives `channels` (1: gray, 3: RGB, 4: RGBA) values in 0..1, y growing downwards."""
    kind = {1: 0, 3: 2, 4: 6}[channels]
    largest = (1 << bits) - 1
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            for value in pixel(x, y):
                code = int(min(max(value, 0.0), 1.0) * largest + 0.5)
                rows += code.to_bytes(bits // 8, "big")

    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))


def write_hdr(path, size, pixel, width=None):
    """A flat Radiance picture (Ward 1991) of size by size, or of another width; pixel(u, v) gives linear
    RGB, u and v in 0..1, v growing downwards."""
    width = width or size

    def rgbe(color):
        largest = max(color)
        if largest < 1e-32:
            return bytes(4)
        mantissa, exponent = math.frexp(largest)
        scale = mantissa * 256 / largest
        return bytes([int(c * scale) for c in color] + [exponent + 128])

    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (size, width))
        for y in range(size):
            for x in range(width):
                file.write(rgbe(pixel((x + 0.5) / width, (y + 0.5) / size)))


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


def clear_sky(z):
    """Radiance at height z >= 0 of the unit sphere: pale at the horizon, blue above."""
    t = math.sqrt(z)
    return [0.75 * (1 - t) + 0.22 * t, 0.80 * (1 - t) + 0.38 * t, 0.85 * (1 - t) + 0.75 * t]
