"""Writes garland.pbrt: garlands of small lamps above a table, triangular lamps at a wall, a thin lens."""

import colorsys
import math

HEADER = """# Garlands of small lamps, bright and faint, and triangular lamps close to a wall, seen through a wide
# lens: what the choice among many lights (--light-selection) and the routines that make points of
# lens and triangles (--routines) differ in shows here. Written by make_scene.py.
LookAt 0 1.7 -5.2  0 1.25 0.6  0 1 0
Camera "perspective" "float fov" 36 "float lensradius" 0.08 "float focaldistance" 4.6
Film "rgb" "integer xresolution" 240 "integer yresolution" 160 "string filename" "garland.exr"
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
Sampler "sobol" "integer pixelsamples" 256
Integrator "path" "integer maxdepth" 5
WorldBegin

Material "diffuse" "rgb reflectance" [0.62 0.58 0.52]
Shape "trianglemesh" "point3 P" [-8 0 -8  8 0 -8  8 0 8  -8 0 8] "integer indices" [0 2 1 0 3 2]
Material "diffuse" "rgb reflectance" [0.45 0.5 0.58]
Shape "trianglemesh" "point3 P" [-8 0 2.2  8 0 2.2  8 6 2.2  -8 6 2.2] "integer indices" [0 2 1 0 3 2]

AttributeBegin
Material "coateddiffuse" "rgb reflectance" [0.5 0.12 0.1] "float roughness" 0.05
Translate -0.9 0.45 0.1
Shape "sphere" "float radius" 0.45
AttributeEnd
AttributeBegin
Material "diffuse" "rgb reflectance" [0.7 0.7 0.68]
Translate 0.3 0.4 -0.5
Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
Material "conductor" "spectrum eta" "metal-Ag-eta" "spectrum k" "metal-Ag-k" "float roughness" 0.02
Translate 1.3 0.5 0.3
Shape "sphere" "float radius" 0.5
AttributeEnd
"""


def lamp(x, y, z, radius, colour, radiance):
    rgb = " ".join(f"{radiance * c:.4g}" for c in colour)
    return (
        "AttributeBegin\n"
        f'AreaLightSource "diffuse" "rgb L" [{rgb}]\n'
        f"Translate {x:.4g} {y:.4g} {z:.4g}\n"
        f'Shape "sphere" "float radius" {radius:.3g}\n'
        "AttributeEnd\n"
    )


def garland(count, z, height, sag, phase):
    """Lamps along a hanging line from left to right; every ninth is ten times as bright."""
    for i in range(count):
        t = (i + 0.5) / count
        y = height - sag * (1 - (2 * t - 1) ** 2) + 0.03 * math.sin(7 * i + phase)
        colour = colorsys.hsv_to_rgb((0.11 * i + phase) % 1, 0.55, 1)
        yield lamp(-3.6 + 7.2 * t, y, z, 0.025, colour, 240 if i % 9 == 4 else 24)


def triangle(x, z, size, rgb):
    """A lamp that stands upright, its face to the wall behind it."""
    return (
        "AttributeBegin\n"
        f'AreaLightSource "diffuse" "rgb L" [{rgb}]\n'
        f'Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [{x - size:.4g} 0.1 {z:.4g}  '
        f"{x + size:.4g} 0.1 {z:.4g}  {x:.4g} {1.8 * size + 0.1:.4g} {z:.4g}]\n"
        "AttributeEnd\n"
    )


with open("garland.pbrt", "w", encoding="ascii") as out:
    out.write(HEADER + '\nMaterial "diffuse" "rgb reflectance" [0 0 0]\n')
    for row in ((60, -0.6, 2.5, 0.7, 0.0), (80, 0.7, 2.7, 0.5, 0.3), (60, 1.9, 2.6, 0.9, 0.6)):
        out.writelines(garland(*row))
    out.write(triangle(-2.1, 2.0, 0.5, "12 5 1.6") + triangle(2.1, 2.05, 0.6, "1.6 4 12"))
