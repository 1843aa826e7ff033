#!/usr/bin/env python3
"""Draws docs/figures/hull_1_cones.svg and so on from the output of `hull_charts`.

usage: hull_charts | hull_figures.py FOLDER
"""

import json
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from svg import (BLACK, BLUE, GREEN, GREY, LIGHT, ORANGE, PURPLE, SKY, VERMILION, Axes, Drawing)

VIEW_COLOURS = [BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY, "#8a6d00", "#444444"]
FACE = "#fbe3c0"
CARVED = "#f2f2f2"


def mix(a, b, t):
    return tuple(x + t * (y - x) for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    n = math.sqrt(dot(a, a))
    return tuple(x / n for x in a)


class Oblique:
    """Parallel projection from space into a box of the drawing."""

    def __init__(self, along, points, box, up=(0.0, 0.0, 1.0)):
        self.x = unit(cross(along, up))
        self.y = unit(cross(along, self.x))
        flat = [(dot(self.x, p), dot(self.y, p)) for p in points]
        low = tuple(min(c) for c in zip(*flat))
        high = tuple(max(c) for c in zip(*flat))
        bx, by, bw, bh = box
        self.scale = min(bw / max(high[0] - low[0], 1e-12), bh / max(high[1] - low[1], 1e-12))
        middle = mix(low, high, 0.5)
        self.shift = (bx + bw / 2 - self.scale * middle[0], by + bh / 2 - self.scale * middle[1])

    def __call__(self, p):
        return (self.shift[0] + self.scale * dot(self.x, p), self.shift[1] + self.scale * dot(self.y, p))


def fit(points, box):
    """Maps pixels of a picture into a box of the drawing."""
    low = tuple(min(c) for c in zip(*points))
    high = tuple(max(c) for c in zip(*points))
    bx, by, bw, bh = box
    s = min(bw / (high[0] - low[0]), bh / (high[1] - low[1]))
    middle = mix(low, high, 0.5)
    return lambda p: (bx + bw / 2 + s * (p[0] - middle[0]), by + bh / 2 + s * (p[1] - middle[1]))


# ---- 1: silhouettes, cones, strips

def strip_segment(data):
    """View and segment of the strip of the shown chart."""
    chart = data["chart"]
    view = data["views"][chart["view"]]
    rays = view["rays"]

    def nearest(ray):
        return max(range(len(rays)), key=lambda r: dot(unit(rays[r]), unit(ray)))
    return view, nearest(chart["rays"][0]), nearest(chart["rays"][1])


def figure_cones(data, path):
    d = Drawing(1180, 470)
    view, begin, end = strip_segment(data)
    points = [p for contour in view["contours"] for p in contour]
    place = fit(points, (40, 60, 230, 360))
    d.text((40, 30), "(a) one silhouette", 14, bold=True)
    d.region([[place(p) for p in c] for c in view["contours"]], "#dfeaf3", stroke=BLUE, width=1.5)
    for p in points:
        d.dot(place(p), 2.2, BLUE)
    a, b = place(points[begin]), place(points[end])
    d.line(a, b, stroke=VERMILION, width=4)
    d.note((40, 440), "a closed polygon of segments;\nholes by the even-odd rule", 12, fill=GREY)

    chosen = [data["chart"]["view"], (data["chart"]["view"] + 2) % 8, (data["chart"]["view"] + 5) % 8]
    ends = []
    for v in chosen:
        one = data["views"][v]
        ends += [tuple(c + 3.9 * r for c, r in zip(one["centre"], ray)) for ray in one["rays"]] + [one["centre"]]
    see = Oblique(unit((-0.5, 0.8, -0.42)), ends, (310, 75, 500, 350))
    d.text((310, 30), "(b) viewing cones of three cameras; each segment spans a strip", 14, bold=True)
    for v in chosen:
        one, colour = data["views"][v], VIEW_COLOURS[v]
        far = [tuple(c + 3.9 * r for c, r in zip(one["centre"], ray)) for ray in one["rays"]]
        for p in far:
            d.line(see(one["centre"]), see(p), stroke=colour, width=0.6, opacity=0.55)
        count = 0
        for contour in one["contours"]:
            loop = far[count:count + len(contour)]
            d.path([see(p) for p in loop], stroke=colour, width=1.2, closed=True)
            count += len(contour)
        d.dot(see(one["centre"]), 5, colour)
        d.text((see(one["centre"])[0], see(one["centre"])[1] - 12), f"camera {v}", 12, "middle", colour, bold=True, halo=True)
    c = view["centre"]
    far = [tuple(x + 3.9 * r for x, r in zip(c, view["rays"][i])) for i in (begin, end)]
    d.path([see(c), see(far[0]), see(far[1])], stroke=VERMILION, width=1.5, fill=VERMILION, opacity=0.75, closed=True)

    repair(d, 880)
    d.write(path)


def repair(d, x):
    d.text((x, 30), "(c) made simple, moved, rounded", 14, bold=True)
    centre = (x + 80, 125)
    # two crossing strands, and their replacement
    for shift, title in ((0, "crossing"), (150, "taken apart")):
        cx, cy = centre[0] + shift - 30, centre[1]
        if shift == 0:
            d.region([[(cx - 45, cy - 40), (cx, cy), (cx - 45, cy + 40)], [(cx + 45, cy - 40), (cx, cy), (cx + 45, cy + 40)]],
                     "#dfeaf3")
            d.arrow((cx - 45, cy - 40), (cx + 45, cy + 40), stroke=BLUE, width=1.8)
            d.arrow((cx + 45, cy - 40), (cx - 45, cy + 40), stroke=BLUE, width=1.8)
            d.dot((cx, cy), 3.5, VERMILION)
        else:
            d.region([[(cx - 45, cy - 40), (cx - 9, cy), (cx - 45, cy + 40)], [(cx + 45, cy - 40), (cx + 9, cy), (cx + 45, cy + 40)]],
                     "#dfeaf3")
            for s in (-1, 1):
                d.path([(cx + s * 45, cy - 40), (cx + s * 9, cy)], stroke=BLUE, width=1.8)
                d.arrow((cx + s * 9, cy), (cx + s * 45, cy + 40), stroke=BLUE, width=1.8)
                d.dot((cx + s * 9, cy), 3.5, VERMILION)
        d.text((cx, cy + 62), title, 12, "middle", GREY)
    d.note((x, 208), "two strands turn instead of crossing;\ntheir corners draw back by 1e-3 px", 12, fill=GREY)
    # grid of the rays, jitter
    gx, gy, step = x + 10, 265, 24
    for i in range(9):
        d.line((gx + i * step, gy), (gx + i * step, gy + 5 * step), stroke=LIGHT, width=0.8)
    for i in range(6):
        d.line((gx, gy + i * step), (gx + 8 * step, gy + i * step), stroke=LIGHT, width=0.8)
    for p, q in (((1.2, 4.3), (2.55, 3.45)), ((5.2, 1.2), (6.45, 2.4))):
        a = (gx + p[0] * step, gy + p[1] * step)
        b = (gx + q[0] * step, gy + q[1] * step)
        c = (gx + round(q[0]) * step, gy + round(q[1]) * step)
        d.dot(a, 3, "#ffffff", BLUE)
        d.arrow(a, b, stroke=ORANGE, width=1.5, head=5)
        d.arrow(b, c, stroke=GREEN, width=1.5, head=5)
        d.dot(c, 3.5, VERMILION)
    d.note((x, gy + 5 * step + 22), "each point: moved by up to 1e-6 px (orange),\nits ray rounded to a grid of integers (green);\n"
           "the result is what is intersected, exactly", 12, fill=GREY)


# ---- 2: pencils

def figure_pencil(data, path):
    d = Drawing(1180, 450)
    d.text((40, 30), "(a) half-planes around the line through two cameras", 14, bold=True)
    a, b = (110, 330), (410, 370)
    d.line(mix(a, b, -0.2), mix(a, b, 1.2), stroke=BLACK, width=1.5)
    d.text(mix(a, b, 1.12), "baseline", 12)
    planes = (((95, -205), "#fbe9cc"), ((-25, -250), "#d9e8f4"))
    for across, fill in planes:
        tips = [(p[0] + across[0], p[1] + across[1]) for p in (b, a)]
        d.path([a, b] + tips, stroke=GREY, width=0.8, fill=fill, opacity=0.75, closed=True)

    def in_plane(plane, along, away):
        p = mix(a, b, along)
        return (p[0] + away * planes[plane][0][0], p[1] + away * planes[plane][0][1])
    d.arrow(a, in_plane(1, 0.55, 0.92), stroke=BLUE, width=2.5, head=9)
    d.arrow(b, in_plane(0, 0.4, 0.92), stroke=VERMILION, width=2.5, head=9)
    d.dot(a, 5, BLUE)
    d.dot(b, 5, VERMILION)
    d.text((a[0] - 20, a[1] + 26), "camera A", 12, fill=BLUE, bold=True)
    d.text((b[0] - 50, b[1] + 26), "camera B", 12, fill=VERMILION, bold=True)
    d.note((40, 420), "Each ray of either camera lies in exactly one half-plane;\nhalf-planes are ordered by their angle.", 12, fill=GREY)

    x, w = 600, 540
    d.text((x, 30), "(b) the rays of both cameras by that angle", 14, bold=True)
    first = [e["angle"] for e in data["pencil"]["first"]]
    second = [e["angle"] for e in data["pencil"]["second"]]
    low, high = min(first + second), max(first + second)

    def at(angle):
        return x + w * (angle - low) / (high - low)
    for angles, y, colour, name in ((first, 85, BLUE, "rays of camera A"), (second, 155, VERMILION, "rays of camera B")):
        d.line((x, y), (x + w, y), stroke=LIGHT)
        for angle in angles:
            d.line((at(angle), y - 11), (at(angle), y + 11), stroke=colour, width=1.4)
        d.text((x, y - 18), name, 12, fill=colour)
    # an enlarged part of it
    begin = len(first) // 3
    part = [angle for angle in first if first[begin] <= angle <= first[begin + 9]]
    lower, upper = part[0] - 0.002, part[-1] + 0.002

    def near(angle):
        return x + w * (angle - lower) / (upper - lower)
    d.path([(at(lower), 170), (x, 215)], stroke=GREY, width=0.8, dash="3 3")
    d.path([(at(upper), 170), (x + w, 215)], stroke=GREY, width=0.8, dash="3 3")
    shown = [e for e in data["pencil"]["second"] if lower <= e["angle"] <= upper]
    skipped = sum(e["angle"] < lower for e in data["pencil"]["second"])
    y1, y2 = 255, 325
    last = {}

    def label(where, y, text, colour):
        is_near = abs(where - last.get(y, -99)) < 16
        d.text((where, y + (12 if is_near else 0)), text, 11, "middle", colour)
        last[y] = -99 if is_near else where
    for i, angle in enumerate(part):
        d.line((near(angle), y1 - 12), (near(angle), y1 + 12), stroke=BLUE, width=2)
        label(near(angle), y1 - 18, f"r{i}", BLUE)
    for i, e in enumerate(shown):
        d.line((near(e["angle"]), y2 - 12), (near(e["angle"]), y2 + 12), stroke=VERMILION, width=2)
        label(near(e["angle"]), y2 + 28, f"q{i}", VERMILION)
    # a strip of camera 1 between two of the shown rays
    strips = [(i - skipped, k - skipped) for i, k in data["pencil"]["strips"]]
    strips = [(i, k) for i, k in strips if 0 <= i < k < len(shown)]

    def rays_inside(strip):
        i, k = strip
        return [r for r, angle in enumerate(part) if shown[i]["angle"] < angle < shown[k]["angle"]]
    best = max(strips, key=lambda strip: (len(rays_inside(strip)) <= 4, len(rays_inside(strip))))
    left, right = near(shown[best[0]]["angle"]), near(shown[best[1]]["angle"])
    d.rect(left, y1 - 12, right - left, y2 - y1 + 24, fill=VERMILION, opacity=0.16, stroke=None)
    inside = rays_inside(best)
    pierced = " and ".join(f"r{i}" for i in inside)
    d.note((x, 382), f"Camera B's strip between q{best[0]} and q{best[1]} is pierced by {pierced}, by no other ray.\n"
           "Each ray keeps its place (rank) in the other camera's order: which ray pierces\n"
           "which strip is decided once, for both cameras.", 12, fill=GREY)
    d.write(path)


# ---- 3: chart

def chart_axes(d, data, box, limits):
    return Axes(d, box, (0.0, 1.0), limits, log=False)


def depth_ticks(limits):
    low, high = limits
    steps = [0.02, 0.05, 0.1, 0.2, 0.5]
    span = 1 / low - 1 / high
    step = next(s for s in steps if span / s <= 9)
    first = math.ceil(1 / high / step)
    return [k * step for k in range(first, int(1 / low / step) + 1)]


def frame_chart(axes, limits, title, label=True):
    d = axes.drawing
    bx, by, bw, bh = axes.box
    for depth in depth_ticks(limits):
        y = axes.at(0, 1 / depth)[1]
        d.line((bx, y), (bx + bw, y), stroke=LIGHT)
        d.text((bx - 6, y + 4), f"{depth:.2f} m", 11, "end", GREY)
    d.rect(bx, by, bw, bh, stroke=GREY)
    d.text((bx, by - 14), title, 14, bold=True)
    d.text((bx, by + bh + 18), "first ray", 12, "middle", GREY)
    d.text((bx + bw, by + bh + 18), "second ray", 12, "middle", GREY)
    d.text((bx + bw / 2, by + bh + 18), "phi: place between the two rays", 12, "middle")
    if label:
        d.text((bx - 58, by + bh / 2), "u = 1 / depth, camera above", 12, "middle", turn=-90)


def faces_of(axes, chart, edges=True):
    d = axes.drawing
    for triangle in chart["triangles"]:
        d.path([axes.at(*p) for p in triangle], stroke=FACE, width=0.6, fill=FACE, closed=True)
    if edges:
        for a, b in chart["edges"]:
            d.line(axes.at(*a), axes.at(*b), stroke=BLACK, width=2)


def figure_chart(data, path):
    d = Drawing(1180, 520)
    chart = data["chart"]
    us = [e[1] for p in chart["pieces"] for e in p["ends"]]
    limits = (min(us) - 0.003, max(us) + 0.003)
    axes = chart_axes(d, data, (90, 60, 430, 400), limits)
    frame_chart(axes, limits, "(a) everything that cuts the strip")
    seen = [e[1] for p in chart["pieces"] if p["visible"] for e in p["ends"]]
    lowest, highest = chart["limits"]
    for u0, u1, text in ((min(highest, limits[1]), limits[1], "some camera sees background: too near"),
                         (limits[0], max(lowest, limits[0]), "too far")):
        top, bottom = axes.at(0, u1)[1], axes.at(0, u0)[1]
        d.rect(90, top, 430, bottom - top, fill=CARVED, stroke=None)
        d.text((512, top + 18), text, 12, "end", GREY)
    faces_of(axes, chart, edges=False)
    for piece in chart["pieces"]:
        colour = VIEW_COLOURS[piece["view"]] if piece["visible"] else "#b5b5b5"
        a, b = (axes.at(*e) for e in piece["ends"])
        d.line(a, b, stroke=colour, width=1.8 if piece["visible"] else 0.9)
    limits_near = (min(min(e[1] for t in chart["triangles"] for e in t), min(seen)) + 0.006,
                   max(e[1] for t in chart["triangles"] for e in t) + 0.006)
    near = chart_axes(d, data, (660, 60, 430, 400), limits_near)
    frame_chart(near, limits_near, "(b) where faces can be", label=False)
    d.clip(660, 60, 430, 400)
    faces_of(near, chart, edges=False)
    for piece in chart["pieces"]:
        if not piece["visible"]:
            continue
        a, b = (near.at(*e) for e in piece["ends"])
        d.line(a, b, stroke=VIEW_COLOURS[piece["view"]], width=2)
    for event in chart["events"]:
        d.dot(near.at(event["phi"], event["u"]), 4, "#ffffff", VIEW_COLOURS[event["view"]], 2)
    d.end_clip()
    views = sorted({p["view"] for p in chart["pieces"]})
    for i, v in enumerate(views):
        y = 80 + 20 * i
        d.line((1105, y - 4), (1125, y - 4), stroke=VIEW_COLOURS[v], width=2.5)
        d.text((1130, y), f"cam {v}", 11)
    d.dot((1113, 80 + 20 * len(views) + 6), 4, "#ffffff", BLACK, 2)
    d.text((1124, 80 + 20 * len(views) + 10), "event", 11)
    d.rect(1106, 80 + 20 * len(views) + 24, 14, 10, fill=FACE, stroke=GREY, width=0.8)
    d.text((1124, 80 + 20 * len(views) + 34), "face", 11)
    d.note((90, 500), "Cuts are straight lines, because u is 1 / depth. A line bends where its own camera's ray pierces the strip (event). "
           "Grey lines are hidden: no face can be where they are.", 12, fill=GREY)
    d.write(path)


# ---- 4: sweep

def figure_sweep(data, path):
    d = Drawing(1180, 560)
    chart = data["chart"]
    phi = chart["sweep_phi"]
    lines = [g["below"] for g in chart["gaps"][:-1]]
    limits = (min(e[1] for t in chart["triangles"] for e in t) - 0.004, max(lines) + 0.004)
    axes = chart_axes(d, data, (90, 60, 400, 420), limits)
    frame_chart(axes, limits, "(a) the sweep")
    d.clip(90, 60, 400, 420)
    faces_of(axes, chart)
    for piece in chart["pieces"]:
        if piece["visible"]:
            a, b = (axes.at(*e) for e in piece["ends"])
            d.line(a, b, stroke=VIEW_COLOURS[piece["view"]], width=1)
    d.end_clip()
    x = axes.at(phi, limits[0])[0]
    d.line((x, 60), (x, 480), stroke=VERMILION, width=2)
    d.text((x, 54), "sweep", 12, "middle", VERMILION)
    # the list of the lines and the verdicts between
    gaps = [g for g in chart["gaps"] if g["below"] > limits[0]]
    row = 420 / len(gaps)
    d.text((560, 46), "(b) its state: which cameras", 14, bold=True)
    d.text((560, 63), "     carve each gap", 14, bold=True)
    for i, gap in enumerate(gaps):
        y = 74 + row * i
        is_face = not gap["carving"]
        d.rect(570, y, 150, row - 4, fill=FACE if is_face else CARVED, stroke=BLACK if is_face else None, width=1.5)
        text = "nobody: a face" if is_face else ", ".join(str(v) for v in gap["carving"])
        d.text((645, y + row / 2 + 2), text, 12, "middle", bold=is_face)
        u = max(min(0.5 * (gap["above"] + gap["below"]), limits[1]), limits[0])
        d.path([(x + 2, axes.at(phi, u)[1]), (490, axes.at(phi, u)[1]), (568, y + row / 2)], stroke=GREY, width=0.6,
               dash="2 3")
    # the faces in space
    d.text((850, 46), "(c) the faces in the strip's plane,", 14, bold=True)
    d.text((850, 63), "     and their triangles", 14, bold=True)
    plane = plane_of(chart)
    points = [plane(p) for t in chart["triangles"] for p in t]
    stretch = squeeze(points)
    place = fit([stretch(p) for p in points], (850, 90, 290, 400))
    for t in chart["triangles"]:
        d.path([place(stretch(plane(p))) for p in t], stroke=BLUE, width=0.8, fill=FACE, closed=True)
    for a, b in chart["edges"]:
        d.line(place(stretch(plane(a))), place(stretch(plane(b))), stroke=BLACK, width=1.8)
    d.note((90, 520), "From left to right the sweep keeps the visible lines by u and, for each gap, the set of cameras that carve it. Passing a line changes one camera's bit;\n"
           "hidden lines count as passed before all others, or after them. At events and crossings the state changes: faces begin, split, merge and end, and\n"
           "their triangles come out of the same pass. Diagonals (blue) are then exchanged to the constrained Delaunay triangulation of each face.", 12, fill=GREY)
    d.write(path)


def plane_of(chart):
    """Converts chart coordinates to metres in the strip's plane."""
    f, t = chart["rays"]
    e1 = unit(f)
    rest = sub(t, tuple(dot(e1, t) * c for c in e1))
    e2 = unit(rest)
    flat = lambda r: (dot(e1, r), dot(e2, r))
    a, b = flat(f), flat(t)
    return lambda p: tuple(c / p[1] for c in mix(a, b, p[0]))


def squeeze(points):
    """Rotates the faces until their longer direction is vertical."""
    low = tuple(min(c) for c in zip(*points))
    high = tuple(max(c) for c in zip(*points))
    tall = high[0] - low[0] >= high[1] - low[1]
    return (lambda p: (p[1], p[0])) if tall else (lambda p: (p[0], -p[1]))


# ---- 5: names

def loop_of(edges):
    """Loops of directed edges, by vertex name."""
    after = {e["from_key"]: e for e in edges}
    loops = []
    while after:
        first = next(iter(after))
        key, loop = first, []
        while key in after:
            e = after.pop(key)
            loop.append(e)
            key = e["to_key"]
        loops.append(loop)
    return loops


def name_of(key):
    if key >> 62 & 1:
        return f"ray {key >> 32 & 0x3fffffff}, {key & 0xffffffff}"
    return "{" + ", ".join(str(key >> s & 0xfffff) for s in (40, 20, 0)) + "}"


def figure_names(data, path):
    d = Drawing(1180, 460)
    corner = data["corner"]
    d.text((40, 30), "(a) three faces, each found in a strip of its own, and the names of their vertices", 14, bold=True)
    normal = unit(tuple(sum(f["normal"][c] for f in corner["faces"]) for c in range(3)))
    along = tuple(-c for c in normal)
    points, loops = [], []
    for f in corner["faces"]:
        for loop in loop_of(f["edges"]):
            if any(e["from_key"] == corner["key"] for e in loop):
                loops.append((f, loop))
                points += [e["from"] for e in loop]
    see = Oblique(along, points, (90, 60, 560, 360))
    middle = {}
    for f, loop in loops:
        colour = VIEW_COLOURS[f["view"]]
        places = [see(e["from"]) for e in loop]
        centre = tuple(sum(c) / len(places) for c in zip(*places))
        inner = [mix(p, centre, 0.04) for p in places]
        d.path(inner, stroke=colour, width=2, fill=colour, opacity=0.25, closed=True)
        d.path(inner, stroke=colour, width=2, closed=True)
        d.text(centre, f"strip {f['strip']}", 13, "middle", colour, bold=True)
        d.text((centre[0], centre[1] + 16), f"of camera {f['view']}", 12, "middle", colour)
        for e in loop:
            middle[e["from_key"]] = e["from"]
    for key, p in middle.items():
        q = see(p)
        is_corner = key == corner["key"]
        d.dot(q, 5 if is_corner else 3, VERMILION if is_corner else BLACK)
        near = sum(1 for other in middle.values() if math.dist(see(other), q) < 26)
        if is_corner or near == 1:
            d.text((q[0] + 8, q[1] - 7), name_of(key), 13 if is_corner else 10, fill=VERMILION if is_corner else GREY,
                   bold=is_corner, halo=True)
    d.note((40, 435), "A vertex is named by the strips that meet in it, or by a ray and a strip. Equal names join the faces; positions are never compared.",
           12, fill=GREY)

    phantom = data["phantom"]
    d.text((760, 30), "(b) a phantom: a component without viewing edge", 14, bold=True)
    corners = [p for t in phantom["triangles"] for p in t]
    low = tuple(min(c) for c in zip(*corners))
    high = tuple(max(c) for c in zip(*corners))
    long = sub(high, low)
    see = Oblique(unit((-0.4, 0.75, -0.5)), corners, (800, 70, 320, 250))
    view = unit((-0.4, 0.75, -0.5))
    ordered = sorted(phantom["triangles"], key=lambda t: -sum(dot(view, p) for p in t))
    for t in ordered:
        n = cross(sub(t[1], t[0]), sub(t[2], t[0]))
        front = dot(n, view) < 0
        shade = FACE if front else "#ffffff"
        d.path([see(p) for p in t], stroke=BLACK if front else GREY, width=1.6 if front else 0.9, fill=shade if front else None,
               dash=None if front else "4 3", closed=True)
    size = 1e3 * math.sqrt(dot(long, long))
    d.note((760, 350), f"Real, from the same person in 8 views of {phantom['segments_per_view']} segments:\n"
           f"{size:.1f} mm long, {1e9 * phantom['volume_m3']:.0f} mm3, bounded by the inside of\nfour strips. It is inside of all cones, "
           "but no silhouette\nneeds it, and a walk that starts at viewing edges\nnever gets there. Dropped and counted by default.", 12, fill=GREY)
    d.write(path)


# ---- 6: partial views, bounds, regions

def figure_fields(data, path):
    d = Drawing(1180, 440)
    field = data["field"]
    everything = [p for c in field["contours"] for p in c] + field["field"]
    place = fit(everything, (40, 55, 330, 340))
    d.text((40, 30), "(a) one picture: a partial view", 14, bold=True)
    border = [place(p) for p in field["field"]]
    d.rect(30, 45, 350, 360, fill="#efe9f3", stroke=None)
    d.path(border, stroke=None, fill="#ffffff", closed=True)
    d.clip(min(p[0] for p in border), min(p[1] for p in border),
           max(p[0] for p in border) - min(p[0] for p in border), max(p[1] for p in border) - min(p[1] for p in border))
    d.region([[place(p) for p in c] for c in field["contours"]], "#dfeaf3")
    d.end_clip()
    d.region([[place(p) for p in c] for c in field["contours"]], None, stroke="#c0c0c0", width=0.8)
    style = {0: (BLUE, 2.5, None), 1: (VERMILION, 2.5, None), 2: (PURPLE, 2.5, "6 4")}
    ends = {}
    for s in field["segments"]:
        colour, width, dash = style[s["kind"]]
        a, b = (place(p) for p in s["ends"])
        d.line(a, b, stroke=colour, width=width, dash=dash)
        for p in s["ends"]:
            ends.setdefault(tuple(p), set()).add(s["kind"])
    for p, kinds in ends.items():
        if len(kinds) == 3:
            d.dot(place(p), 5.5, "#ffffff", BLACK, 2)
    xs = [p[0] for p in border]
    ys = [p[1] for p in border]
    d.text((min(xs) + 8, min(ys) + 18), "background: carves", 12, fill=VERMILION)
    inside = [p for c in field["contours"] for p in c]
    middle = place((sum(p[0] for p in inside) / len(inside), min(p[1] for p in inside) + 0.38 * (max(p[1] for p in inside) - min(p[1] for p in inside))))
    d.text((middle[0] + 14, middle[1]), "foreground", 12, "middle", BLUE, halo=True)
    d.text((372, 398), "unknown", 12, "end", PURPLE)
    for i, (kind, text) in enumerate(((0, "silhouette"), (1, "field's border, background inside"), (2, "field's border, foreground inside"))):
        y = 60 + 20 * i
        colour, width, dash = style[kind]
        d.line((395, y), (420, y), stroke=colour, width=width, dash=dash)
        d.text((426, y + 4), text, 11)
    d.dot((407, 124), 5.5, "#ffffff", BLACK, 2)
    d.text((426, 128), "junction: a ray with three strips", 11)
    d.note((395, 170), "The camera carves only what it\nshows as background. The dashed\npart becomes strips only where\n"
           "a number of cameras that have\nto see is asked for (min_views).", 12, fill=GREY)

    bounds_panel(d, 660)
    regions_panel(d, 930)
    d.write(path)


def bounds_panel(d, x):
    d.text((x, 30), "(b) bounds: two octants", 14, bold=True)
    box = [(i & 1, (i >> 1) & 1, (i >> 2) & 1) for i in range(8)]
    ends = [(-0.2, -0.2, -0.2), (1.35, 0, 0), (0, 1.35, 0), (0, 0, 1.35), (1.2, 1.2, 1.2)]
    see = Oblique(unit((-0.55, 0.75, -0.42)), box + ends, (x, 60, 230, 260))
    low, high = (0, 0, 0), (1, 1, 1)
    for i, p in enumerate(box):
        for q in box[i + 1:]:
            if sum(abs(a - b) for a, b in zip(p, q)) == 1:
                d.line(see(p), see(q), stroke=GREY, width=0.8)
    for axis in range(3):
        away = tuple(1.35 if a == axis else 0 for a in range(3))
        back = tuple(-0.35 if a == axis else 1 for a in range(3))
        d.arrow(see(low), see(away), stroke=BLUE, width=2)
        d.arrow(see(high), see(back), stroke=ORANGE, width=2)
    d.dot(see(low), 5, BLUE)
    d.dot(see(high), 5, ORANGE)
    d.note((x, 350), "Each octant is the cone of a view with\nthree rays: no special case follows.", 12, fill=GREY)


def regions_panel(d, x):
    d.text((x, 30), "(c) regions, from above", 14, bold=True)
    d.rect(x + 10, 110, 100, 150, stroke=BLUE, width=2, fill="#eef4f9")
    d.rect(x + 115, 110, 100, 150, stroke=ORANGE, width=2, fill="#fdf5e6")
    for cx, cy, colour in ((10, 90, BLUE), (60, 85, BLUE), (5, 275, BLUE), (70, 285, BLUE)):
        d.path([(x + cx, cy), (x + cx + 12, cy), (x + cx + 6, cy + (10 if cy < 150 else -10))], stroke=colour, fill=colour, closed=True)
    for cx, cy, colour in ((150, 85, ORANGE), (205, 90, ORANGE), (150, 285, ORANGE), (210, 275, ORANGE)):
        d.path([(x + cx, cy), (x + cx + 12, cy), (x + cx + 6, cy + (10 if cy < 150 else -10))], stroke=colour, fill=colour, closed=True)
    for cx, cy in ((50, 170), (75, 215), (165, 190)):
        d.dot((x + cx, cy), 10, "#bbbbbb", BLACK, 1.2)
    d.note((x, 350), "One hull each, from its own cameras\nand without silhouettes outside of it.", 12, fill=GREY)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    figures = {"1_cones": figure_cones, "2_pencil": figure_pencil, "3_chart": figure_chart, "4_sweep": figure_sweep,
               "5_names": figure_names, "6_fields": figure_fields}
    content = json.load(sys.stdin)
    for name, draw in figures.items():
        draw(content, os.path.join(sys.argv[1], f"hull_{name}.svg"))
