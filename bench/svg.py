"""Makes drawings for docs/figures without any package: shapes and text in one SVG file, and diagrams with axes."""

import math
from html import escape

# Okabe and Ito's palette, which colour-blind readers can tell apart.
BLACK, GREY, LIGHT = "#000000", "#767676", "#e6e6e6"
ORANGE, SKY, GREEN, YELLOW = "#e69f00", "#56b4e9", "#009e73", "#f0e442"
BLUE, VERMILION, PURPLE = "#0072b2", "#d55e00", "#cc79a7"


class Drawing:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.parts = []

    def add(self, text):
        self.parts.append(text)

    @staticmethod
    def _style(stroke, width, fill, opacity, dash):
        out = f'fill="{fill or "none"}"'
        if stroke:
            out += f' stroke="{stroke}" stroke-width="{width:g}" stroke-linejoin="round"'
        if opacity != 1:
            out += f' opacity="{opacity:g}"'
        if dash:
            out += f' stroke-dasharray="{dash}"'
        return out

    def path(self, points, stroke=BLACK, width=1.0, fill=None, opacity=1, dash=None, closed=False):
        d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + ("Z" if closed else "")
        self.add(f'<path d="{d}" {self._style(stroke, width, fill, opacity, dash)}/>')

    def region(self, loops, fill, opacity=1, stroke=None, width=1.0):
        """Even-odd interior of several loops."""
        d = "".join("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in loop) + "Z" for loop in loops)
        self.add(f'<path d="{d}" fill-rule="evenodd" {self._style(stroke, width, fill, opacity, None)}/>')

    def line(self, a, b, **style):
        self.path([a, b], **style)

    def rect(self, x, y, w, h, **style):
        self.path([(x, y), (x + w, y), (x + w, y + h), (x, y + h)], closed=True, **style)

    def dot(self, p, radius=2.5, fill=BLACK, stroke=None, width=1.0):
        edge = f' stroke="{stroke}" stroke-width="{width:g}"' if stroke else ""
        self.add(f'<circle cx="{p[0]:.1f}" cy="{p[1]:.1f}" r="{radius:g}" fill="{fill}"{edge}/>')

    def text(self, p, text, size=12, anchor="start", fill=BLACK, bold=False, turn=0, halo=False):
        extra = ' font-weight="bold"' if bold else ""
        extra += ' stroke="#ffffff" stroke-width="4" paint-order="stroke"' if halo else ""
        extra += f' transform="rotate({turn:g} {p[0]:.1f} {p[1]:.1f})"' if turn else ""
        self.add(f'<text x="{p[0]:.1f}" y="{p[1]:.1f}" font-size="{size:g}" text-anchor="{anchor}" '
                 f'fill="{fill}"{extra}>{escape(text)}</text>')

    def note(self, p, text, size=12, anchor="start", fill=BLACK, gap=1.3, **style):
        for i, row in enumerate(text.split("\n")):
            self.text((p[0], p[1] + i * gap * size), row, size, anchor, fill, **style)

    def arrow(self, a, b, stroke=BLACK, width=1.0, head=6.0, dash=None):
        dx, dy = b[0] - a[0], b[1] - a[1]
        n = math.hypot(dx, dy) or 1.0
        ux, uy = dx / n, dy / n
        base = (b[0] - head * ux, b[1] - head * uy)
        self.path([a, base], stroke=stroke, width=width, dash=dash)
        side = 0.4 * head
        self.path([b, (base[0] - side * uy, base[1] + side * ux), (base[0] + side * uy, base[1] - side * ux)],
                  stroke=None, fill=stroke, closed=True)

    def clip(self, x, y, w, h):
        name = f"clip{len(self.parts)}"
        self.add(f'<clipPath id="{name}"><rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}"/></clipPath>'
                 f'<g clip-path="url(#{name})">')

    def end_clip(self):
        self.add("</g>")

    def write(self, path):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:g}" height="{self.height:g}" '
                f'viewBox="0 0 {self.width:g} {self.height:g}" font-family="DejaVu Sans, Verdana, sans-serif">'
                f'<rect width="100%" height="100%" fill="#ffffff"/>')
        with open(path, "w", encoding="utf-8") as file:
            file.write(head + "\n" + "\n".join(self.parts) + "\n</svg>\n")


def ticks_log(low, high):
    out = []
    for e in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1):
        for m in (1, 2, 5):
            if low <= m * 10.0 ** e <= high:
                out.append(m * 10.0 ** e)
    return out


class Axes:
    """A diagram in the box (x, y, w, h) of a drawing."""

    def __init__(self, drawing, box, x_range, y_range, log=True):
        self.drawing, self.box, self.log = drawing, box, log
        self.x_range, self.y_range = x_range, y_range

    @staticmethod
    def _share(value, limits, log):
        low, high = limits
        if log:
            return (math.log(value) - math.log(low)) / (math.log(high) - math.log(low))
        return (value - low) / (high - low)

    def at(self, x, y):
        bx, by, bw, bh = self.box
        return (bx + bw * self._share(x, self.x_range, self.log),
                by + bh * (1 - self._share(y, self.y_range, self.log)))

    def frame(self, title, x_label, y_label, x_ticks, y_ticks):
        d = self.drawing
        bx, by, bw, bh = self.box
        for t in x_ticks:
            x = self.at(t, self.y_range[0])[0]
            d.line((x, by), (x, by + bh), stroke=LIGHT)
            d.text((x, by + bh + 15), f"{t:g}", 11, "middle", GREY)
        for t in y_ticks:
            y = self.at(self.x_range[0], t)[1]
            d.line((bx, y), (bx + bw, y), stroke=LIGHT)
            d.text((bx - 6, y + 4), f"{t:g}", 11, "end", GREY)
        d.rect(bx, by, bw, bh, stroke=GREY)
        d.text((bx, by - 10), title, 13, bold=True)
        d.text((bx + bw / 2, by + bh + 33), x_label, 12, "middle")
        d.text((bx - 40, by + bh / 2), y_label, 12, "middle", turn=-90)

    def curve(self, points, colour, width=2.0, dash=None, dots=True):
        places = [self.at(x, y) for x, y in points]
        self.drawing.path(places, stroke=colour, width=width, dash=dash)
        if dots:
            for p in places:
                self.drawing.dot(p, 2.6, colour)
