#!/usr/bin/env python3
"""Draws the textures of the delivered worlds: deploy/worlds/make_textures.py writes models/*.png beside itself.

Transparent texels show the object's colour, so one texture serves objects of many colours.
"""
import math
import pathlib
import struct
import zlib

SAMPLES = 3  # per axis and pixel


def png(width, height, rgba):
    def chunk(name, data):
        return struct.pack('>I', len(data)) + name + data + struct.pack('>I', zlib.crc32(name + data))

    rows = b''.join(b'\0' + rgba[4 * width * y:4 * width * (y + 1)] for y in range(height))
    header = struct.pack('>IIBBBBB', width, height, 8, 6, 0, 0, 0)
    return b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', zlib.compress(rows, 9)) + chunk(b'IEND', b'')


def draw(width, height, paint):
    """`paint(u, v)` returns r, g, b, a in [0, 1] at (u, v); (0, 0) is the top left."""
    out = bytearray()
    steps = [(i + 0.5) / SAMPLES for i in range(SAMPLES)]
    for y in range(height):
        for x in range(width):
            samples = [paint((x + i) / width, (y + j) / height) for i in steps for j in steps]
            alpha = sum(s[3] for s in samples)
            colour = [sum(s[c] * s[3] for s in samples) / alpha if alpha > 0 else 1.0 for c in range(3)]
            out += bytes(round(255 * min(1.0, max(0.0, v))) for v in (*colour, alpha / len(samples)))
    return png(width, height, bytes(out))


def noise(x, y, period):
    """Smooth value noise of wavelength 1 that repeats after `period` each way, 0 to 1."""
    def value(i, j):
        h = (i % period) * 0x8da6b343 ^ (j % period) * 0xd8163841
        h = ((h ^ (h >> 15)) * 0x2c1b3c6d) & 0xffffffff
        h = ((h ^ (h >> 12)) * 0x297a2d39) & 0xffffffff
        return (h ^ (h >> 15)) / 0xffffffff

    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    top = value(i, j) * (1 - u) + value(i + 1, j) * u
    bottom = value(i, j + 1) * (1 - u) + value(i + 1, j + 1) * u
    return top * (1 - v) + bottom * v


def checks(u, v):
    """White squares on a ball of any colour."""
    return 1.0, 1.0, 1.0, float((math.floor(8 * u) + math.floor(4 * v)) % 2)


def football_faces():
    golden = (1 + math.sqrt(5)) / 2
    pentagons = [p for a in (-1, 1) for b in (-golden, golden) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    near = 2.1  # longer than an edge of the icosahedron, shorter than anything else
    hexagons = []
    for i, p in enumerate(pentagons):
        for j in range(i):
            for k in range(j):
                q, r = pentagons[j], pentagons[k]
                if max(math.dist(p, q), math.dist(q, r), math.dist(r, p)) < near:
                    hexagons.append(tuple(sum(c) for c in zip(p, q, r)))
    unit = lambda p: tuple(c / math.hypot(*p) for c in p)
    return [(unit(p), True) for p in pentagons] + [(unit(h), False) for h in hexagons]


FACES = football_faces()


def football(u, v):
    """Twelve black faces and twenty white ones, with seams."""
    elevation, turn = math.pi * (0.5 - v), 2 * math.pi * u
    p = (math.cos(elevation) * math.cos(turn), math.cos(elevation) * math.sin(turn), math.sin(elevation))
    # a black face is somewhat smaller than a white one
    near = sorted(((math.acos(min(1.0, sum(a * b for a, b in zip(p, f)))) + (0.055 if black else 0.0), black)
                   for f, black in FACES))[:2]
    grey = 0.10 if near[0][1] else 0.35 if near[1][0] - near[0][0] < 0.03 else 0.95
    return grey, grey, grey, 1.0


def wood(u, v):
    """Two boards with grain along u; repeats."""
    board = math.floor(2 * v)
    grain = noise(4 * u + 7 * board, 40 * v, 40) * 0.6 + noise(16 * u, 96 * v, 96) * 0.4
    tone = (0.94 if board else 1.0) * (0.80 + 0.30 * grain)
    if min(2 * v % 1.0, 1.0 - 2 * v % 1.0) < 0.02:
        tone *= 0.6
    return 0.72 * tone, 0.52 * tone, 0.33 * tone, 1.0


def crate(u, v):
    """A face of a crate: five boards in a frame with a slanting one, in the crate's own colour."""
    edge = min(u, v, 1 - u, 1 - v)
    slant = abs(u - v) < 0.09
    on_frame = edge < 0.12
    along = u if on_frame and min(v, 1 - v) <= min(u, 1 - u) else v
    dark = 0.10 + 0.25 * noise(8 * along if on_frame else 40 * u, 40 * along if on_frame else 6 * v, 40)
    if not on_frame and not slant:
        dark += 0.15 + (0.5 if 5 * u % 1.0 < 0.06 else 0.0)
    if abs(edge - 0.12) < 0.008 or (not on_frame and abs(abs(u - v) - 0.09) < 0.01):
        dark += 0.4
    return 0.10, 0.06, 0.03, min(0.85, dark)


def domino(u, v):
    """Three pips above a line and four below, on any colour."""
    pips = [(0.25, 0.12), (0.5, 0.25), (0.75, 0.38), (0.28, 0.62), (0.72, 0.62), (0.28, 0.88), (0.72, 0.88)]
    on_pip = any(math.hypot(u - x, 2 * (v - y)) < 0.10 for x, y in pips)
    on_line = abs(v - 0.5) < 0.012 and 0.12 < u < 0.88
    return 1.0, 1.0, 0.97, 1.0 if on_pip or on_line else 0.0


def main():
    folder = pathlib.Path(__file__).parent / 'models'
    for paint, width, height in ((checks, 256, 128), (football, 384, 192), (wood, 256, 256), (crate, 192, 192),
                                 (domino, 64, 128)):
        (folder / f'{paint.__name__}.png').write_bytes(draw(width, height, paint))


if __name__ == '__main__':
    main()
