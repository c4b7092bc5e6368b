#!/usr/bin/env python3
"""Writes an NFF scene as a POV-Ray 3.7 scene, with the shading of NFF files that docs/scene_format.md describes.

    nff_to_pov.py SCENE.nff SCENE.pov

The camera is made for one sample per pixel corner of a 512 x 512 picture. Render with +W513 +H513 -A -J. NFF measures
the angle of view between the centres of the first and the last pixel row, which are 511 px apart. POV-Ray renders 513
rows, one for each row of corners, and measures the angle over all 513 of them. The tangent of half its angle is
therefore 513/511 times that of NFF.

Two declarations on POV-Ray's command line make it possible to count rays. Declare=Max_Depth=N sets the depth, which is
5 by default. With Declare=Clear_Glass=1, transparent objects cast no shadows.

POV-Ray is left-handed only because of its default camera. The output sets the right vector of the camera in the
right-handed coordinates of the NFF file. The geometry is therefore unchanged, and the picture is not mirrored.
"""

import math
import sys

RASTER_PX = 512
MAX_DEPTH = 5  # levels of a shading tree, including the eye ray, that the SPD scenes require
# Largest transmittance T of a surface that this script converts to POV-Ray. T must be below 1, because the script
# divides the diffuse and ambient light by 1 - T. POV-Ray multiplies them by this factor, but NFF does not.
LARGEST_TRANSMITTANCE = 1 - 1e-6
DEFAULT_FILL = [1.0, 1.0, 1.0, 0.8, 0.0, 32.0, 0.0, 1.0]
# Tolerance of the test whether a polygon is convex. The outline of a convex polygon always turns in the same direction.
# Since coordinates are rounded to six digits, opposite turns are accepted if the sine of the angle is at most this
# value.
LARGEST_REFLEX = 1e-4


class NffError(Exception):
    """An error in the scene, with file and line."""


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normalized(v):
    length = math.sqrt(dot(v, v))
    return [x / length for x in v]


def pov(v):
    return "<" + ",".join(repr(float(x)) for x in v) + ">"


class Tokens:
    """The words of an NFF file without comments, with their line numbers."""

    def __init__(self, path):
        self.path = path
        self.words = []
        with open(path, encoding="utf-8", errors="replace") as file:
            for line, text in enumerate(file, 1):
                self.words += [(word, line) for word in text.split("#")[0].split()]
        self.at = 0

    def fail(self, text):
        line = self.words[min(max(self.at - 1, 0), len(self.words) - 1)][1] if self.words else 1
        raise NffError(f"{self.path}:{line}: {text}")

    def peek(self):
        return self.words[self.at][0] if self.at < len(self.words) else None

    def word(self):
        if self.at == len(self.words):
            self.fail("the file ends within an entity")
        self.at += 1
        return self.words[self.at - 1][0]

    def number(self):
        text = self.word()
        try:
            value = float(text)
        except ValueError:
            self.fail(f"not a number (got {text})")
        if not math.isfinite(value):
            self.fail(f"not a finite number (got {text})")
        return value

    def numbers(self, count):
        return [self.number() for _ in range(count)]

    def numbers_of_line(self):
        """Returns the remaining numbers on the line of the last word."""
        line = self.words[self.at - 1][1]
        values = []
        while self.at < len(self.words) and self.words[self.at][1] == line:
            values.append(self.number())
        return values


def camera(view):
    forward = normalized(subtract(view["at"], view["from"]))
    right = normalized(cross(forward, view["up"]))
    up = cross(right, forward)
    edge = 2 * math.tan(math.radians(view["angle"][0]) / 2) * (RASTER_PX + 1) / (RASTER_PX - 1)
    return (
        f"camera {{ perspective location {pov(view['from'])} direction {pov(forward)}\n"
        f"  right {pov([edge * x for x in right])} up {pov([edge * x for x in up])} }}"
    )


def material(fill):
    *colour, kd, ks, shine, transmittance, ior = fill
    transmittance = min(transmittance, LARGEST_TRANSMITTANCE)
    kd /= 1 - transmittance
    text = (
        f"texture {{ pigment {{ rgbf {pov([*colour, transmittance])} }}"
        f" finish {{ ambient {kd:.9g} diffuse {kd:.9g} specular 0 phong {ks:.9g} phong_size {shine:.9g}"
        f" reflection {{ {min(ks, 1):.9g} }} }} }}"
    )
    if transmittance == 0:
        return text
    return text + f" interior {{ ior {ior:.9g} }}"


def is_convex(corners):
    """Returns whether a fan from the first corner covers the polygon. Collinear corners are treated as convex."""
    normal = [0.0, 0.0, 0.0]
    for a, b in zip(corners, corners[1:] + corners[:1]):
        normal = [n + c for n, c in zip(normal, cross(a, b))]
    if dot(normal, normal) == 0:
        return True
    normal = normalized(normal)
    edges = [subtract(b, a) for a, b in zip(corners, corners[1:] + corners[:1])]
    turns = zip(edges, edges[1:] + edges[:1])
    return all(dot(cross(a, b), normal) >= -LARGEST_REFLEX * math.sqrt(dot(a, a) * dot(b, b)) for a, b in turns)


def triangles(tokens, is_patch):
    """Returns the triangles of a polygon's fan. They have no closing braces, because the material follows."""
    count = tokens.number()
    if count < 3 or count != int(count):
        tokens.fail(f"a polygon has at least three corners (got {count:g})")
    corners, normals = [], []
    for _ in range(int(count)):
        corners.append(tokens.numbers(3))
        normals.append(tokens.numbers(3) if is_patch else None)
    if not is_convex(corners):
        tokens.fail("a concave polygon; only convex ones are converted")
    for i in range(1, int(count) - 1):
        fan = (0, i, i + 1)
        if is_patch:
            yield f"smooth_triangle {{ {','.join(pov(corners[k]) + ',' + pov(normals[k]) for k in fan)}"
        else:
            yield f"triangle {{ {','.join(pov(corners[k]) for k in fan)}"


def curved(tokens, entity):
    """Returns a sphere, cone or cylinder. It has no closing brace, because the material follows."""
    if entity == "s":
        x, y, z, radius = tokens.numbers(4)
        return f"sphere {{ {pov([x, y, z])} {abs(radius):.9g}"
    *base, base_radius = tokens.numbers(4)
    *apex, apex_radius = tokens.numbers(4)
    if base_radius == apex_radius:
        return f"cylinder {{ {pov(base)} {pov(apex)} {abs(base_radius):.9g} open"
    return f"cone {{ {pov(base)} {abs(base_radius):.9g} {pov(apex)} {abs(apex_radius):.9g} open"


class Scene:
    """The contents of an NFF file, with its objects converted to the language of POV-Ray."""

    def __init__(self, path):
        self.view, self.background = {}, [0.0, 0.0, 0.0]
        self.lights, self.materials, self.objects = [], {}, []
        self.fill = DEFAULT_FILL
        self.read(Tokens(path))

    def add(self, shape):
        name = self.materials.setdefault(material(self.fill), f"Fill_{len(self.materials) + 1}")
        shadow = "\n#ifdef (Clear_Glass) no_shadow #end" if self.fill[6] > 0 else ""
        self.objects.append(f"{shape} material {{ {name} }}{shadow} }}")

    def read(self, tokens):
        while tokens.peek() is not None:
            entity = tokens.word()
            if entity == "v":
                self.read_view(tokens)
            elif entity == "b":
                self.background = tokens.numbers(3)
            elif entity == "l":
                values = tokens.numbers_of_line()
                if len(values) not in (3, 6):
                    tokens.fail(f"a light has three or six numbers (got {len(values)})")
                self.lights.append((values[:3], values[3:] or [1.0, 1.0, 1.0]))
            elif entity == "f":
                values = tokens.numbers_of_line()
                if len(values) != len(DEFAULT_FILL):
                    tokens.fail(f"a fill has eight numbers (got {len(values)})")
                if values[6] > 0 and values[7] <= 0:
                    tokens.fail(f"index of refraction is out of range (got {values[7]:g}; expected above 0)")
                self.fill = values
            elif entity in ("s", "c"):
                self.add(curved(tokens, entity))
            elif entity in ("p", "pp"):
                # POV-Ray renders separate triangles faster than a mesh.
                for triangle in triangles(tokens, entity == "pp"):
                    self.add(triangle)
            else:
                tokens.fail(f"unknown entity (got {entity}; expected v, b, l, f, c, s, p or pp)")
        if not self.view or not self.lights or not self.objects:
            raise NffError(f"{tokens.path}: a view, a light and an object are needed")

    def read_view(self, tokens):
        sizes = {"from": 3, "at": 3, "up": 3, "angle": 1, "hither": 1, "resolution": 2}
        while tokens.peek() in sizes:
            field = tokens.word()
            self.view[field] = tokens.numbers(sizes[field])
        missing = [field for field in ("from", "at", "up", "angle") if field not in self.view]
        if missing:
            tokens.fail(f"the view has no '{missing[0]}'")
        forward = subtract(self.view["at"], self.view["from"])
        if dot(cross(forward, self.view["up"]), cross(forward, self.view["up"])) == 0:
            tokens.fail("'from', 'at' and 'up' do not span a view")

    def write(self, out):
        intensity = math.sqrt(len(self.lights)) / (2 * len(self.lights))
        out.write(f"#version 3.7;\n#ifndef (Max_Depth) #declare Max_Depth = {MAX_DEPTH}; #end\n")
        out.write(
            "global_settings { assumed_gamma 1 max_trace_level Max_Depth adc_bailout 0"
            f" ambient_light rgb {intensity:.9g} }}\n"
        )
        out.write(f"background {{ rgb {pov(self.background)} }}\n{camera(self.view)}\n")
        for position, colour in self.lights:
            out.write(f"light_source {{ {pov(position)} rgb {pov([intensity * x for x in colour])} }}\n")
        for text, name in self.materials.items():
            out.write(f"#declare {name} = material {{ {text} }}\n")
        out.write("\n".join(self.objects) + "\n")


def main(arguments):
    if len(arguments) != 3:
        print("usage: nff_to_pov.py SCENE.nff SCENE.pov", file=sys.stderr)
        return 2
    try:
        scene = Scene(arguments[1])
        with open(arguments[2], "w", encoding="utf-8") as out:
            scene.write(out)
    except NffError as error:
        print(f"nff_to_pov.py: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"nff_to_pov.py: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
