#!/usr/bin/env python3
"""Writes materials.gltf, its buffer and its images beside this script: the surfaces of glTF 2.0 on one
table; and bare.gltf, a skin, a morph target and nodes in nodes without a light or a camera. Same bytes
each time, standard library alone."""
import json
import math
import pathlib
import struct
import zlib

FOLDER = pathlib.Path(__file__).parent
FLOAT, UNSIGNED_SHORT, UNSIGNED_BYTE = 5126, 5123, 5121

buffer = bytearray()
scene = {}


def begin(**more):
    """An empty scene."""
    buffer.clear()
    scene.clear()
    scene.update({"asset": {"version": "2.0", "generator": "make_scene.py"}, "scene": 0,
                  "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [],
                  "accessors": [], "bufferViews": [], **more})


def write(name):
    (FOLDER / f"{name}.bin").write_bytes(buffer)
    scene["buffers"] = [{"uri": f"{name}.bin", "byteLength": len(buffer)}]
    (FOLDER / f"{name}.gltf").write_text(json.dumps(scene, indent=1) + "\n")


def append(array, element):
    scene[array].append(element)
    return len(scene[array]) - 1


def accessor(values, components, component_type=FLOAT, normalized=False):
    while len(buffer) % 4:
        buffer.append(0)
    code = {FLOAT: "f", UNSIGNED_SHORT: "H", UNSIGNED_BYTE: "B"}[component_type]
    data = struct.pack(f"<{len(values)}{code}", *values)
    view = append("bufferViews", {"buffer": 0, "byteOffset": len(buffer), "byteLength": len(data)})
    buffer.extend(data)
    element = {
        "bufferView": view,
        "componentType": component_type,
        "count": len(values) // components,
        "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[components],
    }
    if normalized:
        element["normalized"] = True
    if component_type == FLOAT and components == 3:
        rows = [values[i::3] for i in range(3)]
        element["min"], element["max"] = [min(r) for r in rows], [max(r) for r in rows]
    return append("accessors", element)


def png(name, width, height, pixel, channels=3):
    """pixel(x, y) gives bytes; row 0 is the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(
            ">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y))
                    for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    (FOLDER / name).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                                chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
    return append("images", {"uri": name})


def texture(image, sampler=None):
    element = {"source": image}
    if sampler is not None:
        element["sampler"] = sampler
    return append("textures", element)


def sphere_attributes(columns=48, rows=24):
    positions, normals, coordinates, indices = [], [], [], []
    for row in range(rows + 1):
        theta = math.pi * row / rows
        for column in range(columns + 1):
            phi = 2 * math.pi * column / columns
            n = (math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi))
            positions += n
            normals += n
            coordinates += (column / columns, row / rows)
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b = a + columns + 1
            indices += [a, b, b + 1, a, b + 1, a + 1]
    return ({"POSITION": accessor(positions, 3), "NORMAL": accessor(normals, 3),
             "TEXCOORD_0": accessor(coordinates, 2)}, accessor(indices, 1, UNSIGNED_SHORT))


def square_attributes(x0, x1, y0, y1):
    """In the plane z = 0, seen from +z, an image upright on it."""
    return ({"POSITION": accessor([x0, y0, 0, x1, y0, 0, x1, y1, 0, x0, y1, 0], 3),
             "TEXCOORD_0": accessor([0, 1, 1, 1, 1, 0, 0, 0], 2)},
            accessor([0, 1, 2, 0, 2, 3], 1, UNSIGNED_SHORT))


def mesh(attributes, indices, material, **more):
    primitive = {"attributes": attributes, "indices": indices, "material": material, **more}
    return append("meshes", {"primitives": [primitive]})


def node(**properties):
    scene["scenes"][0]["nodes"].append(append("nodes", properties))


def spiral(count, attributes, indices, material, **place):
    """Each ball is the child of the one below it, and smaller and turned against it."""
    ball = mesh(attributes, indices, material)
    child = None
    for i in range(count):
        below = {"mesh": ball} if child is None else {"mesh": ball, "children": [child]}
        if i == count - 1:
            return node(**below, **place)
        child = append("nodes", {**below, "translation": [0.9, 1.25, 0], "scale": [0.78] * 3,
                                 "rotation": turn(60, 0, 1, 0)})


def surface(color, metallic, roughness, **more):
    return append("materials", {
        "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic,
                                 "roughnessFactor": roughness}, **more})


def turn(degrees, x, y, z):
    half = math.radians(degrees) / 2
    return [x * math.sin(half), y * math.sin(half), z * math.sin(half), math.cos(half)]


def aim(eye, target):
    """The shortest rotation of -z to the direction from eye to target."""
    d = [t - e for t, e in zip(target, eye)]
    length = math.sqrt(sum(v * v for v in d))
    x, y, z = (v / length for v in d)
    w = 1 - z
    norm = math.sqrt(y * y + x * x + w * w)
    return [y / norm, -x / norm, 0, w / norm]


def materials():
    begin(images=[], samplers=[{"wrapS": 33648, "wrapT": 10497}, {"wrapS": 33071, "wrapT": 33071}],
          textures=[], cameras=[], extensions={"KHR_lights_punctual": {"lights": []}},
          extensionsUsed=[
              "KHR_lights_punctual", "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
              "KHR_materials_ior", "KHR_materials_specular", "KHR_materials_transmission",
              "KHR_materials_unlit", "KHR_materials_volume", "KHR_texture_transform"])
    sphere, sphere_indices = sphere_attributes()

    # The table: tiles, repeated and turned by the texture's transform.
    def tile(x, y):
        edge = x in (0, 63) or y in (0, 63)
        return (70, 66, 60) if edge else (196, 188, 172) if (x < 32) != (y < 32) else (150, 158, 166)
    tiles = texture(png("tiles.png", 64, 64, tile), 0)
    table = append("materials", {
        "pbrMetallicRoughness": {
            "baseColorTexture": {
                "index": tiles,
                "extensions": {"KHR_texture_transform": {"scale": [5, 5], "rotation": 0.35}}},
            "metallicFactor": 0, "roughnessFactor": 0.45}})
    node(mesh=mesh(*square_attributes(-12, 12, -12, 12), table), rotation=turn(-90, 1, 0, 0))

    # Back row: gold from smooth to rough. Middle row: plastic likewise.
    for i in range(5):
        x = 2.3 * (i - 2)
        roughness = 0.05 + 0.2 * i
        gold = surface((1, 0.77, 0.34), 1, roughness)
        node(mesh=mesh(sphere, sphere_indices, gold), translation=[x, 1, -2.6])
        plastic = surface((0.75, 0.06, 0.05), 0, roughness)
        node(mesh=mesh(sphere, sphere_indices, plastic), translation=[x, 0.8, 0], scale=[0.8] * 3)

    # Front row: coat, pane-like bubble, glass, emission by a map, colours of vertices.
    car = surface((0.02, 0.1, 0.35), 0.6, 0.5, extensions={
        "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.03}})
    bubble = surface((0.6, 0.9, 0.7), 0, 0.15, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 0.9}})
    glass = surface((1, 1, 1), 0, 0, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_volume": {
            "thicknessFactor": 1, "attenuationColor": [0.45, 0.8, 0.95],
            "attenuationDistance": 0.8}})

    def stripe(x, y):
        return (255, 150, 40) if (x // 8 + y // 8) % 4 == 0 else (0, 0, 0)
    lava = append("materials", {
        "pbrMetallicRoughness": {"baseColorFactor": [0.05, 0.05, 0.05, 1], "metallicFactor": 0,
                                 "roughnessFactor": 0.6},
        "emissiveFactor": [1, 1, 1],
        "emissiveTexture": {"index": texture(png("stripes.png", 64, 64, stripe))},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 6}}})
    painted = surface((1, 1, 1), 0, 0.7)
    count = scene["accessors"][sphere["POSITION"]]["count"]
    columns, colors = 49, []
    for i in range(count):
        phi, theta = 2 * math.pi * (i % columns) / (columns - 1), math.pi * (i // columns) / 24
        colors += [round(127.5 * (1 + math.cos(phi + k * 2 * math.pi / 3) * math.sin(theta)))
                   for k in range(3)]
    rainbow = dict(sphere, COLOR_0=accessor(colors, 3, UNSIGNED_BYTE, True))
    for i, (attributes, material) in enumerate(
            [(sphere, car), (sphere, bubble), (sphere, glass), (sphere, lava), (rainbow, painted)]):
        node(mesh=mesh(attributes, sphere_indices, material), translation=[1.9 * (i - 2), 0.65, 2.3],
             scale=[0.65] * 3)

    # A fence of one mesh in several nodes, with holes.
    def bars(x, y):
        hole = (x % 16 - 7.5) ** 2 + (y % 16 - 7.5) ** 2 < 30
        return (225, 225, 230, 0 if hole else 255)
    holes = append("materials", {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": texture(
            png("holes.png", 64, 64, bars, 4), 1)}, "metallicFactor": 0.9, "roughnessFactor": 0.35},
        "alphaMode": "MASK", "doubleSided": True})
    fence = mesh(*square_attributes(-1.4, 1.4, 0, 2.4), holes)
    for x, degrees in ((-5.2, 38), (5.2, -38)):
        node(mesh=fence, translation=[x, 0, 0.9], rotation=turn(degrees, 0, 1, 0))

    back_wall()

    # In front: specular reflection taken away, as it is, and coloured; nodes in nodes.
    for i, specular in enumerate([{"specularFactor": 0}, {},
                                  {"specularColorFactor": [0.3, 1, 0.4]}]):
        ball = surface((0.02, 0.02, 0.02), 0, 0.25,
                       extensions={"KHR_materials_specular": specular, "KHR_materials_ior":
                                   {"ior": 2.2}})
        node(mesh=mesh(sphere, sphere_indices, ball), translation=[1.0 * (i - 1), 0.36, 4.1],
             scale=[0.36] * 3)
    spiral(6, sphere, sphere_indices, surface((0.8, 0.45, 0.15), 0, 0.5),
           translation=[-3.0, 0.36, 4.0], scale=[0.36] * 3)

    # A lamp over the table, a sun from the left, a narrow spot, and a point light on the right.
    lamp = append("materials", {
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
        "emissiveFactor": [1, 0.96, 0.9],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 9}}})
    node(mesh=mesh(*square_attributes(-3, 3, -2, 2), lamp), translation=[0, 7, 0.5],
         rotation=turn(90, 1, 0, 0))
    lights = scene["extensions"]["KHR_lights_punctual"]["lights"]
    lights.append({"type": "directional", "intensity": 0.7, "color": [1, 0.9, 0.75]})
    node(rotation=[*turn(-40, 1, 0, 0)], extensions={"KHR_lights_punctual": {"light": 0}})
    lights.append({"type": "spot", "intensity": 60, "color": [0.6, 0.75, 1],
                   "spot": {"innerConeAngle": 0.12, "outerConeAngle": 0.28}})
    node(translation=[-6, 6, 6], rotation=aim([-6, 6, 6], [0, 0, 2]),
         extensions={"KHR_lights_punctual": {"light": 1}})

    lights.append({"type": "point", "intensity": 5, "color": [1, 0.55, 0.25]})
    node(translation=[3.6, 0.9, 3.6], extensions={"KHR_lights_punctual": {"light": 2}})

    append("cameras", {"type": "perspective", "name": "table", "perspective": {
        "yfov": 0.5, "aspectRatio": 16 / 9, "znear": 0.1}})
    node(camera=0, translation=[0, 5.6, 14.5], rotation=turn(-19.5, 1, 0, 0))

    write("materials")


def back_wall():
    """Four panels: normals of studs, with an occlusion that is left out; metal and paint by one map; a
    veil of partial alpha; a sign that is not lit."""
    def stud(x, y):
        """Across a stud of radius 12, in pixels from its middle."""
        dx, dy = x % 32 - 15.5, y % 32 - 15.5
        return dx, dy, math.hypot(dx, dy) < 12

    def normals(x, y):
        dx, dy, on = stud(x, y)
        if not on:
            return (128, 128, 255)
        slope = 0.055  # of the cosine; rows grow downwards
        n = (slope * dx, -slope * dy, math.sqrt(1 - slope * slope * (dx * dx + dy * dy)))
        return tuple(round(127.5 + 127.5 * v) for v in n)
    studs = append("materials", {
        "pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.4, 0.55, 1], "metallicFactor": 0,
                                 "roughnessFactor": 0.35},
        "normalTexture": {"index": texture(png("studs.png", 128, 128, normals)), "scale": 0.9},
        "occlusionTexture": {"index": texture(png(
            "occlusion.png", 32, 32, lambda x, y: (255 if stud(x, y)[2] else 160,) * 3))}})

    def metal(x, y):
        """Roughness in green, metal in blue: plates of smooth metal between rough paint."""
        plate = x % 32 >= 5 and y % 32 >= 5
        return (0, 60 + (x // 32 + y // 32) * 20, 255) if plate else (0, 230, 0)
    plates = append("materials", {
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.9, 0.6, 0.45, 1],
            "metallicRoughnessTexture": {"index": texture(png("plates.png", 128, 128, metal))}}})

    def cloth(x, y):
        return (230, 235, 240, 40 + 210 * y // 63 if x % 16 < 12 else 255)
    veil = append("materials", {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": texture(png(
            "veil.png", 64, 64, cloth, 4), 1)}, "metallicFactor": 0, "roughnessFactor": 0.9},
        "alphaMode": "BLEND", "doubleSided": True})

    def arrow(x, y):
        """Upwards."""
        inside = abs(x - 31.5) < (y - 8 if y < 32 else 8) and 8 < y < 56
        return (255, 210, 40) if inside else (20, 70, 120)
    sign = append("materials", {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": texture(png(
            "sign.png", 64, 64, arrow), 1)}},
        "extensions": {"KHR_materials_unlit": {}}})
    for i, material in enumerate([studs, plates, veil, sign]):
        node(mesh=mesh(*square_attributes(-1.4, 1.4, 0, 2.8), material),
             translation=[3.3 * (i - 1.5), 0.7, -5.2])


def tube_attributes(joints, columns=24, rows=24, radius=0.28, height=2.4):
    """Upright, with weights that pass from each of the joints, evenly up its length, to the next."""
    positions, normals, numbers, weights, indices = [], [], [], [], []
    for row in range(rows + 1):
        t = row / rows
        below = min(int(t * (joints - 1)), joints - 2)
        above = t * (joints - 1) - below
        for column in range(columns + 1):
            phi = 2 * math.pi * column / columns
            positions += (radius * math.sin(phi), height * t, radius * math.cos(phi))
            normals += (math.sin(phi), 0, math.cos(phi))
            numbers += (below, below + 1, 0, 0)
            weights += (1 - above, above, 0, 0)
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b = a + columns + 1
            indices += [a, a + 1, b + 1, a, b + 1, b]
    return ({"POSITION": accessor(positions, 3), "NORMAL": accessor(normals, 3),
             "JOINTS_0": accessor(numbers, 4, UNSIGNED_BYTE), "WEIGHTS_0": accessor(weights, 4)},
            accessor(indices, 1, UNSIGNED_SHORT))


def petals(columns=48, rows=24):
    """The morph target of a sphere of so many: seven petals around it."""
    def point(row, column):
        theta, phi = math.pi * row / rows, 2 * math.pi * column / columns
        r = 1 + 0.5 * math.sin(theta) ** 2 * math.sin(7 * phi)
        return [r * math.sin(theta) * math.sin(phi), math.cos(theta),
                r * math.sin(theta) * math.cos(phi)]

    def normal(row, column):
        down = [b - a for a, b in zip(point(row - 0.01, column), point(row + 0.01, column))]
        along = [b - a for a, b in zip(point(row, column - 0.01), point(row, column + 0.01))]
        n = [down[1] * along[2] - down[2] * along[1], down[2] * along[0] - down[0] * along[2],
             down[0] * along[1] - down[1] * along[0]]
        length = math.sqrt(sum(v * v for v in n))
        return [v / length for v in n] if 0 < row < rows else [0, math.cos(math.pi * row / rows), 0]
    moves, turns = [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            theta, phi = math.pi * row / rows, 2 * math.pi * column / columns
            n = (math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi))
            moves += [b - a for a, b in zip(n, point(row, column))]
            turns += [b - a for a, b in zip(n, normal(row, column))]
    return {"POSITION": accessor(moves, 3), "NORMAL": accessor(turns, 3)}


def bare():
    begin(skins=[])
    node(mesh=mesh(*square_attributes(-3.2, 3.2, -2.2, 2.2), surface((0.5, 0.5, 0.48), 0, 0.9)),
         rotation=turn(-90, 1, 0, 0))

    # One tube straight, and one whose four joints are each turned against the one below.
    tube, tube_indices = tube_attributes(4)
    straight = {name: tube[name] for name in ("POSITION", "NORMAL")}
    blue = surface((0.1, 0.25, 0.55), 0, 0.3)
    node(mesh=mesh(straight, tube_indices, blue), translation=[-2.4, 0, -0.4])
    child, joints = None, []
    for i in reversed(range(4)):
        joint = {"rotation": turn(-28, 0, 0, 1)} if i else {"translation": [-1.5, 0, -0.4]}
        if i:
            joint["translation"] = [0, 0.8, 0]
        if child is not None:
            joint["children"] = [child]
        child = append("nodes", joint)
        joints.insert(0, child)
    scene["scenes"][0]["nodes"].append(child)
    matrices = [v for i in range(4)
                for v in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.8 * i, 0, 1)]
    append("skins", {"joints": joints, "inverseBindMatrices": accessor(matrices, 16)})
    node(mesh=mesh(tube, tube_indices, blue), skin=0)

    # A ball, and the same half and all the way to petals.
    sphere, sphere_indices = sphere_attributes()
    red = surface((0.6, 0.1, 0.06), 0, 0.25)
    flower = mesh(sphere, sphere_indices, red, targets=[petals()])
    for x, weight in ((0.15, 0), (1.25, 0.5), (2.45, 1)):
        node(mesh=flower, weights=[weight], translation=[x, 0.45, 0.75], scale=[0.45] * 3,
             rotation=turn(40, 1, 0, 0))
    spiral(7, sphere, sphere_indices, surface((0.9, 0.65, 0.3), 1, 0.2),
           translation=[1.4, 0.42, -0.9], scale=[0.42] * 3)
    write("bare")


if __name__ == "__main__":
    materials()
    bare()
