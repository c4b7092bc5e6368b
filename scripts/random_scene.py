"""Makes random scenes for tests, which reveal errors that scenes made by hand do not. The same seed always gives the
same scene.

Each scene has a camera, 3 to 12 objects at distances of 1 to 12 m from the camera, one to three lights, and in most
cases a floor. The seed determines the kind of scene: plain, mirror, glass, texture (a checker), area (lights that have
an extent), gloss (reflections and refractions by rough surfaces) or motion (objects that move and turn while the
shutter is open from 0 to 1 s). Scenes of the kind "leaves" (trees whose leaves are one mesh) are made only on request.
"""

import dataclasses
import math
import random

KINDS = ("plain", "mirror", "glass", "texture", "area", "gloss", "motion")
F_NUMBERS = (0.7, 1, 1.4, 2, 2.8, 5.6)


@dataclasses.dataclass
class RandomScene:
    kind: str
    f_number: float
    focus_m: float
    text: str  # content of the scene file
    shutter: bool  # whether the shutter is open from 0 to 1 s

    def lens(self):
        return ["--f-number", str(self.f_number), "--focus", f"{self.focus_m:.6g}"]

    def traced_for(self):
        """Returns the options with which `trace` records the scene for its lens and shutter."""
        out = ["--for-f-number", str(self.f_number), "--for-focus", f"{self.focus_m:.6g}", "--overscan", "auto"]
        return out + (["--for-shutter", "0:1", "--keys", "auto"] if self.shutter else [])

    def rendered_for(self):
        return self.lens() + (["--shutter", "0:1"] if self.shutter else [])


def vector(*values):
    return "[" + ", ".join(f"{v:.6g}" for v in values) + "]"


class Maker:
    def __init__(self, seed, kinds):
        self.random = random.Random(seed)
        self.kind = kinds[seed % len(kinds)]
        self.lines = []

    def between(self, low, high):
        return self.random.uniform(low, high)

    def chance(self, probability):
        return self.random.random() < probability

    def colour(self, low, high):
        return vector(*(self.between(low, high) for _ in range(3)))

    def direction(self):
        d = [self.between(-1, 1) for _ in range(3)]
        length = math.hypot(*d)
        return [x / length for x in d]

    def make(self):
        focus_m = self.between(1.5, 6)
        f_number = self.random.choice(F_NUMBERS)
        self.lines += ["[scene]", f"background = {self.colour(0, 0.6)}"]
        self.lines += ["[[camera]]", "focal_length_mm = 50", f"f_number = {f_number}", f"focus_m = {focus_m:.6g}"]
        for _ in range(self.random.randint(1, 3)):
            self.light()
        self.lines += ["[[texture]]", 'name = "checker"', 'kind = "checker"', f"size_m = {self.between(0.05, 0.4):.4g}"]
        self.lines += ["offset_m = [0.0131, 0.0173, 0.0197]"]  # so that no plane coincides with the border of a cell
        self.lines += [f"even = {self.colour(0.5, 1)}", f"odd = {self.colour(0, 0.3)}"]
        if self.chance(0.8):
            self.material("floor")
            self.thing("floor", ['shape = "plane"', "normal = [0, 1, 0]",
                                 f"point_m = {vector(0, self.between(-1.2, -0.5), 0)}"], moves=False)
        for i in range(self.random.randint(3, 12)):
            self.material(f"material {i}")
            self.body(f"material {i}")
        return RandomScene(self.kind, f_number, focus_m, "\n".join(self.lines) + "\n", self.kind == "motion")

    def light(self):
        kinds = ["sphere", "rectangle"] if self.kind == "area" else ["point", "directional"]
        kind = self.random.choice(kinds)
        self.lines += ["[[light]]", f'kind = "{kind}"', f"intensity = {self.colour(0.3, 0.9)}"]
        if kind == "directional":
            self.lines += [f"direction = {vector(self.between(-1, 1), self.between(-1, -0.3), self.between(-1, 0.2))}"]
            return
        self.lines += [f"position_m = {vector(self.between(-4, 4), self.between(1, 5), self.between(-3, 3))}"]
        size = self.between(0.1, 1)
        if kind == "sphere":
            self.lines += [f"radius_m = {size:.4g}"]
        elif kind == "rectangle":
            self.lines += [f"edge_u_m = {vector(size, 0, 0)}", f"edge_v_m = {vector(0, 0, size)}"]

    def material(self, name):
        self.lines += ["[[material]]", f'name = "{name}"', f"colour = {self.colour(0.2, 1)}"]
        if self.kind == "texture" and self.chance(0.6):
            self.lines += ['colour_texture = "checker"']
        if self.chance(0.3):
            self.lines += [f"specular = {self.between(0.1, 0.5):.3g}", f"shininess = {self.random.choice([8, 30, 100])}"]
        if self.kind in ("mirror", "gloss") and self.chance(0.5):
            self.lines += [f"reflection = {self.between(0.1, 0.8):.3g}"]
            if self.kind == "gloss":
                self.lines += [f"reflection_exponent = {self.random.choice([30, 100, 1000])}"]
        elif self.kind in ("glass", "gloss") and self.chance(0.5):
            self.lines += [f"transmission = {self.between(0.4, 0.9):.3g}", f"ior = {self.between(1.05, 1.6):.3g}",
                           "reflection = 0.08"]
            if self.kind == "gloss":
                self.lines += [f"transmission_exponent = {self.random.choice([100, 1000])}"]
        if self.chance(0.1):
            self.lines += [f"emission = {self.between(0.2, 3):.3g}"]

    def thing(self, material, lines, moves=True):
        self.lines += ["[[object]]", f'material = "{material}"', *lines]
        if self.kind == "motion" and moves and self.chance(0.6):
            by = vector(*(self.between(-0.4, 0.4) for _ in range(3)))
            turn = f"rotate_degrees = {self.between(-40, 40):.4g}, rotate_axis = {vector(*self.direction())}"
            # The object rotates about the origin of the scene, not about its own centre, so the rotation also moves it.
            self.lines += [f"keys = [{{ time_s = 0 }}, {{ time_s = 1, translate_m = {by}"
                           + (f", {turn}" if self.chance(0.3) else "") + " }]"]

    def leaves(self, material, centre, size):
        positions, faces = [], []
        count, leaf = round(10 ** self.between(1.5, 3)), size * 10 ** self.between(-2, -0.7)
        for i in range(count):
            out = self.between(0.3, 1) * size
            at = [c + out * d for c, d in zip(centre, self.direction())]
            u, v = self.direction(), self.direction()
            along = sum(a * b for a, b in zip(u, v))
            v = [b - along * a for a, b in zip(u, v)]
            for by_u, by_v in ((-leaf, 0), (0, -leaf / 2), (leaf, 0), (0, leaf / 2)):
                positions.append(vector(*(p + by_u * a + by_v * b for p, a, b in zip(at, u, v))))
            faces.append(f"[{4 * i}, {4 * i + 1}, {4 * i + 2}, {4 * i + 3}]")
        self.thing(material, ['shape = "mesh"', f"positions_m = [{', '.join(positions)}]", f"faces = [{', '.join(faces)}]"])

    def body(self, material):
        z = -1 / self.between(1 / 12, 1 / 1.1)
        reach, size = -0.36 * z, -self.between(0.04, 0.16) * z
        centre = (self.between(-reach, reach), self.between(-0.6 * reach, 0.6 * reach), z)
        axis = self.direction()
        if self.kind == "leaves" and self.chance(0.5):
            self.leaves(material, centre, 2 * size)
            return
        end = tuple(c + 2.5 * size * a for c, a in zip(centre, axis))
        shape = self.random.choice(["sphere", "box", "cylinder", "cone", "disc", "rectangle", "joint"])
        if shape == "sphere":
            self.thing(material, ['shape = "sphere"', f"centre_m = {vector(*centre)}", f"radius_m = {size:.6g}"])
        elif shape == "box":
            edges = vector(*(self.between(0.1, 2) * size for _ in range(3)))
            self.thing(material, ['shape = "box"', f"size_m = {edges}", f"translate_m = {vector(*centre)}",
                                  f"rotate_degrees = {self.between(0, 180):.5g}", f"rotate_axis = {vector(*axis)}"])
        elif shape == "cone":
            self.thing(material, ['shape = "cone"', f"base_m = {vector(*centre)}", f"apex_m = {vector(*end)}",
                                  f"base_radius_m = {size / 2:.6g}"])
        elif shape == "disc":
            self.thing(material, ['shape = "disc"', f"centre_m = {vector(*centre)}", f"normal = {vector(*axis)}",
                                  f"radius_m = {size:.6g}"])
        elif shape == "rectangle":
            u = vector(size, size * self.between(-0.5, 0.5), size * self.between(-0.5, 0.5))
            v = vector(size * self.between(-0.5, 0.5), size, size * self.between(-0.5, 0.5))
            self.thing(material, ['shape = "rectangle"', f"corner_m = {vector(*centre)}", f"edge_u_m = {u}", f"edge_v_m = {v}"])
        else:
            # The shape is a cylinder or a "joint": a cylinder without caps, with a sphere of the same radius at one
            # end.
            radius = size * self.between(0.05, 0.5)
            capped = "false" if shape == "joint" else "true"
            self.thing(material, ['shape = "cylinder"', f"base_m = {vector(*centre)}", f"apex_m = {vector(*end)}",
                                  f"radius_m = {radius:.6g}", f"capped = {capped}"], moves=shape != "joint")
            if shape == "joint":
                self.thing(material, ['shape = "sphere"', f"centre_m = {vector(*end)}", f"radius_m = {radius:.6g}"], moves=False)


def write(seed, kinds=KINDS):
    """The scene of a seed."""
    return Maker(seed, kinds).make()
