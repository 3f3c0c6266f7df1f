"""Writes PNG files: what the scripts that draw the scenes' images have in common."""

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
