#!/usr/bin/env python3
"""Draws the three figures of docs/how_it_works.md to scale, with the formulas of a thin lens.

    how_it_works.py OUT     writes coc.svg, hidden.svg and mirror.svg
"""

import os
import sys

BLUE, ORANGE, GREY, GREEN = "#0072b2", "#d55e00", "#888888", "#009e73"


class Drawing:
    """A figure of 720 x height px. y points up, and one unit is one pixel."""

    def __init__(self, height):
        self.height, self.items = height, []

    def line(self, x1, y1, x2, y2, colour="black", width=1.5, dashed=False):
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.items.append(f'<line x1="{x1:.1f}" y1="{self.height / 2 - y1:.1f}" x2="{x2:.1f}" y2="{self.height / 2 - y2:.1f}" '
                          f'stroke="{colour}" stroke-width="{width}"{dash}/>')

    def dot(self, x, y, colour):
        self.items.append(f'<circle cx="{x:.1f}" cy="{self.height / 2 - y:.1f}" r="4" fill="{colour}"/>')

    def text(self, x, y, words, anchor="middle", colour="black"):
        self.items.append(f'<text x="{x:.1f}" y="{self.height / 2 - y:.1f}" text-anchor="{anchor}" fill="{colour}">{words}</text>')

    def lens(self, x, radius):
        top, bottom = self.height / 2 - radius, self.height / 2 + radius
        self.items.append(f'<path d="M{x} {top} Q{x + 16} {self.height / 2} {x} {bottom} Q{x - 16} {self.height / 2} {x} {top}" '
                          f'fill="#dbe9f4" stroke="black"/>')

    def write(self, path):
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 {self.height}" width="720" height="{self.height}" '
                       f'font-family="sans-serif" font-size="14"><rect width="720" height="{self.height}" fill="white"/>\n')
            file.write("\n".join(self.items) + "\n</svg>\n")


def coc(path):
    """A point before the focus plane becomes a disc on the film."""
    d = Drawing(300)
    lens, film, radius, y = 440, 600, 80, 30
    v = film - lens
    f = 1 / (1 / v + 1 / 300)  # focal length for which a point 300 in front of the lens is in focus
    for z, colour, name in ((300, BLUE, "in focus"), (190, ORANGE, "nearer")):
        image = 1 / (1 / f - 1 / z)
        at = -y * image / z
        d.dot(lens - z, y, colour)
        d.text(lens - z - 10, y - 5, name, "end", colour)
        ends = []
        for edge in (radius, -radius):
            d.line(lens - z, y, lens, edge, colour)
            end = edge + (at - edge) * v / image
            ends.append(end)
            d.line(lens, edge, film, end, colour)
        if z == 190:
            d.line(film + 8, ends[0], film + 8, ends[1], ORANGE, 4)
            d.text(film + 16, sum(ends) / 2 - 5, "circle of", "start", ORANGE)
            d.text(film + 16, sum(ends) / 2 - 21, "confusion", "start", ORANGE)
    d.lens(lens, radius)
    d.line(film, 110, film, -110, "black", 3)
    d.line(lens - 300, 110, lens - 300, -110, GREY, dashed=True)
    d.line(60, 0, film, 0, GREY, 0.8)
    d.text(lens - 300, -128, "focus plane", colour=GREY)
    d.text(lens, -128, "lens")
    d.text(film, -128, "film")
    d.write(path)


def hidden(path):
    """Points near the rim of the lens see past the edge of a near object."""
    d = Drawing(280)
    lens, radius, edge, wall = 560, 70, 330, 90
    sees = lambda z, y, x: y + (z - y) * (lens - x) / (lens - edge)  # height at x of the line from (lens, y) through (edge, z)
    d.line(edge, 0, edge, -115, ORANGE, 6)
    d.text(edge + 12, -100, "near object", "start", ORANGE)
    d.line(wall, 115, wall, 0, BLUE, 6)
    lowest = sees(0, radius, wall)
    d.line(wall, 0, wall, lowest, GREEN, 6)
    d.text(wall + 12, 100, "what the pinhole sees", "start", BLUE)
    d.text(wall + 12, lowest - 12, "hidden behind the edge,", "start", GREEN)
    d.text(wall + 12, lowest - 30, "but seen from the rim", "start", GREEN)
    d.line(lens, 0, wall, 0, "black")
    d.line(lens, radius, wall, lowest, GREEN)
    d.lens(lens, radius)
    d.dot(lens, 0, "black")
    d.text(lens + 22, -4, "pinhole", "start")
    d.text(lens + 22, radius - 8, "rim", "start", GREEN)
    d.write(path)


def mirror(path):
    """In a flat mirror, the distance of an object's image is the length of the light path. In a mirror ball, the image
    is near."""
    d = Drawing(280)
    eye, glass = 640, 380
    thing, y = 540, 95
    image = 2 * glass - thing
    d.line(glass, 120, glass, -120, GREY, 5)
    d.text(glass + 8, -112, "flat mirror", "start", GREY)
    d.dot(thing, y, ORANGE)
    d.text(thing, y + 12, "thing", colour=ORANGE)
    d.dot(image, y, BLUE)
    d.text(image, y + 12, "its image: in focus at this depth", colour=BLUE)
    for at in (-18, 18):
        hit = y + (at - y) * (glass - image) / (eye - image)
        d.line(thing, y, glass, hit, ORANGE)
        d.line(glass, hit, eye, at, ORANGE)
        d.line(image, y, glass, hit, BLUE, 1.2, True)
    d.lens(eye, 28)
    d.text(eye, -48, "lens")
    d.write(path)


def main():
    if len(sys.argv) != 2:
        sys.exit("how_it_works.py: where to? (expected a folder)")
    os.makedirs(sys.argv[1], exist_ok=True)
    for draw in (coc, hidden, mirror):
        draw(os.path.join(sys.argv[1], draw.__name__ + ".svg"))


if __name__ == "__main__":
    main()
