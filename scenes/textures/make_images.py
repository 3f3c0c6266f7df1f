#!/usr/bin/env python3
"""Draws the images of textures.pbrt: card.png, a test card, and sky.hdr, a painted sky."""

import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from images import clear_sky, equal_area_direction, write_hdr, write_png  # noqa: E402

CARD_SIZE = 128


def card(x, y):
    """Coloured bands, a ring, and a corner of its own so that a flip is seen; in 0..255."""
    u, v = (x + 0.5) / CARD_SIZE, (y + 0.5) / CARD_SIZE
    ring = abs(math.hypot(u - 0.5, v - 0.5) - 0.3) < 0.04
    if ring:
        return (235, 235, 225)
    if u < 0.2 and v < 0.2:
        return (190, 40, 35)
    bands = [(52, 76, 110), (220, 160, 60), (60, 130, 110), (200, 195, 180)]
    return bands[int(v * 8) % 4] if int(u * 8) % 2 else bands[(int(v * 8) + 2) % 4]


def sky(u, v):
    """Radiance: brighter towards the horizon, a soft sun, brown ground."""
    x, y, z = equal_area_direction(u, v)
    if z < 0:
        return (0.12, 0.10, 0.08)
    color = clear_sky(z)
    sun = max(0.0, 0.5 * x + 0.6 * y + 0.62 * z) ** 60
    return tuple(c + s * sun for c, s in zip(color, (30, 26, 20)))


if __name__ == "__main__":
    write_png(
        os.path.join(HERE, "card.png"), CARD_SIZE, CARD_SIZE, 3,
        lambda x, y: [value / 255 for value in card(x, y)],
    )
    write_hdr(os.path.join(HERE, "sky.hdr"), 64, sky)
