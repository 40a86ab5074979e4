"""Draws the figures of how-it-works.md: `python figures.py` writes them to docs/images/; with `--check` it compares.

The example is an open ring in the plane, a chain of segments with two modes: the first closes it, the second shears its ends. All
numbers in the figures are computed from it: along 120 directions of q, the first collision of each two parts, by bisection.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations_with_replacement
from pathlib import Path

IMAGES = Path(__file__).parents[1] / "images"

Point = tuple[float, float]

SEGMENTS, DIRECTIONS, REACH = 24, 120, 1.6
PARTS = "ABCD"
EACH = SEGMENTS // len(PARTS)
INK, DIM, RED, GREEN, BLUE = "#1c2330", "#7a8494", "#b3261e", "#1e7d4f", "#0a58b8"


def shape(q: Point) -> list[Point]:
    """The corners of the ring at q: x = p + U q."""
    corners = []
    for i in range(SEGMENTS + 1):
        angle = math.radians(25 + 310 * i / SEGMENTS)
        t = 1 - angle / math.pi  # 0 opposite to the gap, above 0 at the upper end
        u = [(0.15 * t * t, -0.7 * t * abs(t)), (0.6 * t * abs(t), 0.15 * t * t)]
        corners.append(
            (
                math.cos(angle) + u[0][0] * q[0] + u[1][0] * q[1],
                math.sin(angle) + u[0][1] * q[0] + u[1][1] * q[1],
            )
        )
    return corners


def side(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    return side(a, b, c) * side(a, b, d) <= 0 and side(c, d, a) * side(c, d, b) <= 0


def colliding(q: Point, parts: tuple[int, int]) -> bool:
    """Whether two parts have segments that meet and have no common corner."""
    x = shape(q)
    for i in range(parts[0] * EACH, (parts[0] + 1) * EACH):
        for j in range(parts[1] * EACH, (parts[1] + 1) * EACH):
            if j > i + 1 and cross(x[i], x[i + 1], x[j], x[j + 1]):
                return True
    return False


def first(direction: int, parts: tuple[int, int]) -> float:
    """The first |q| in a direction at which two parts collide; infinity: none up to REACH."""
    angle = 2 * math.pi * direction / DIRECTIONS
    at = lambda r: (r * math.cos(angle), r * math.sin(angle))  # noqa: E731
    free = 0.0
    for step in range(1, 17):
        r = REACH * step / 16
        if colliding(at(r), parts):
            hit = r
            for _ in range(12):
                middle = (free + hit) / 2
                free, hit = (free, middle) if colliding(at(middle), parts) else (middle, hit)
            return free
        free = r
    return math.inf


@cache
def collisions() -> dict[tuple[int, int], list[float]]:
    """For each two parts the first collision in each direction."""
    pairs = combinations_with_replacement(range(len(PARTS)), 2)
    return {pair: [first(direction, pair) for direction in range(DIRECTIONS)] for pair in pairs}


def whole() -> list[float]:
    return [min(radii[direction] for radii in collisions().values()) for direction in range(DIRECTIONS)]


def path(points: Sequence[Point], style: str, close: bool = False) -> str:
    d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + ("Z" if close else "")
    return f'<path d="{d}" {style}/>'


def text(x: float, y: float, line: str, style: str = "") -> str:
    return f'<text x="{x:g}" y="{y:g}" {style}>{line}</text>'


def svg(width: int, height: int, title: str, parts: list[str]) -> str:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
    style = f'<g font-family="sans-serif" font-size="13" fill="{INK}">'
    background = f'<rect width="{width}" height="{height}" fill="#fff"/>'
    return "\n".join([head, f"<title>{title}</title>", background, style, *parts, "</g>", "</svg>"]) + "\n"


def ring(q: Point, center: Point, scale: float, color: str = INK, width: float = 2.5) -> str:
    points = [(center[0] + scale * x, center[1] - scale * y) for x, y in shape(q)]
    return path(points, f'fill="none" stroke="{color}" stroke-width="{width}"')


def radius() -> str:
    """The plane of q: where the ring collides, and the circle in which it cannot."""
    center, scale = (180.0, 190.0), 95.0
    radii = whole()
    edge = [
        (
            center[0] + scale * min(r, REACH) * math.cos(2 * math.pi * k / DIRECTIONS),
            center[1] - scale * min(r, REACH) * math.sin(2 * math.pi * k / DIRECTIONS),
        )
        for k, r in enumerate(radii)
    ]
    least = min(radii)
    nearest = radii.index(least)
    angle = 2 * math.pi * nearest / DIRECTIONS
    hit = (least * math.cos(angle), least * math.sin(angle))
    beyond = (1.35 * hit[0], 1.35 * hit[1])
    place = lambda q: (center[0] + scale * q[0], center[1] - scale * q[1])  # noqa: E731
    drawn = [
        f'<circle cx="{center[0]}" cy="{center[1]}" r="{REACH * scale:g}" fill="#f8dcda"/>',
        path(edge, f'fill="#eef1f5" stroke="{DIM}"', close=True),
        f'<circle cx="{center[0]}" cy="{center[1]}" r="{least * scale:.1f}" fill="#d5eedf" stroke="{GREEN}" stroke-width="2"/>',
        path([(center[0] - 165, center[1]), (center[0] + 165, center[1])], f'stroke="{DIM}"'),
        path([(center[0], center[1] - 165), (center[0], center[1] + 165)], f'stroke="{DIM}"'),
        text(center[0] + 120, center[1] - 6, "mode 0"),
        text(center[0] + 6, 32, "mode 1"),
        text(20, 372, "red: it collides; green: proven free by one comparison"),
    ]
    shapes = (((0.0, 0.0), "q = 0", INK), (hit, f"|q| = {least:.2f}, the radius", GREEN), (beyond, "beyond it", RED))
    for number, (q, label, color) in enumerate(shapes):
        x, y = place(q)
        drawn.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{color}"/>')
        drawn.append(ring(q, (450, 75 + 120 * number), 45, color))
        drawn.append(text(510, 80 + 120 * number, label))
    return svg(660, 385, "The plane of q, the collisions, and the radius", drawn)


def rows() -> Iterator[tuple[int, int, float]]:
    for (a, b), radii in collisions().items():
        yield a, b, min(radii)


def pairs() -> str:
    """The radius of each two parts of the ring."""
    drawn = []
    x, colors = shape((0.0, 0.0)), (BLUE, "#7b52ab", "#a06a00", RED)
    for part, color in enumerate(colors):
        corners = x[part * EACH : (part + 1) * EACH + 1]
        drawn.append(path([(130 + 85 * a, 140 - 85 * b) for a, b in corners], f'fill="none" stroke="{color}" stroke-width="4"'))
        middle = corners[EACH // 2]
        drawn.append(text(125 + 108 * middle[0], 145 - 108 * middle[1], PARTS[part], f'font-weight="bold" fill="{color}"'))
    for a, b, least in rows():
        left, top, reached = 300 + 75 * b, 40 + 50 * a, least < math.inf
        fill = "#f8dcda" if reached else "#d5eedf"
        drawn.append(f'<rect x="{left}" y="{top}" width="73" height="48" fill="{fill}"/>')
        drawn.append(text(left + 36, top + 29, f"{least:.2f}" if reached else f"&gt; {REACH}", 'text-anchor="middle"'))
    for k, name in enumerate(PARTS):
        drawn.append(text(336 + 75 * k, 32, name, f'text-anchor="middle" font-weight="bold" fill="{colors[k]}"'))
        drawn.append(text(282 + 75 * k, 69 + 50 * k, name, f'font-weight="bold" fill="{colors[k]}"'))
    return svg(620, 262, "Radii of the parts of the ring, and of each two of them", drawn)


def direction() -> str:
    """Two triangles, a direction, their gap along it, and how fast a mode closes it."""
    a = [(60, 170), (150, 60), (190, 190)]
    b = [(330, 120), (440, 50), (420, 200)]
    fill = 'fill-opacity=".25" stroke-width="2"'
    arrow = f'stroke="{DIM}" stroke-width="2" marker-end="url(#tip)"'
    drawn = [
        f'<defs><marker id="tip" markerWidth="8" markerHeight="8" refX="6" refY="3" orient="auto"><path d="M0 0L6 3L0 6Z" fill="{DIM}"/></marker></defs>',
        path(a, f'fill="{BLUE}" stroke="{BLUE}" {fill}', close=True),
        path(b, f'fill="{RED}" stroke="{RED}" {fill}', close=True),
        path([(190, 20), (190, 230)], f'stroke="{BLUE}" stroke-dasharray="5 4"'),
        path([(330, 20), (330, 230)], f'stroke="{RED}" stroke-dasharray="5 4"'),
        path([(192, 215), (322, 215)], arrow),
        text(260, 208, "n: the gap is h", 'text-anchor="middle"'),
        path([(330, 120), (285, 112)], arrow),
        path([(190, 190), (225, 182)], arrow),
        text(260, 90, "a unit of a mode", 'text-anchor="middle"'),
        text(260, 106, "closes the gap by c", 'text-anchor="middle"'),
        text(250, 255, "with r modes: apart while |q| is below h / sqrt(c1² + ... + cr²)", 'text-anchor="middle"'),
    ]
    return svg(500, 270, "A direction that separates two triangles", drawn)


FIGURES = {"how-radius.svg": radius, "how-pairs.svg": pairs, "how-direction.svg": direction}


def main() -> None:
    """Writes or compares the figures."""
    for name, draw in FIGURES.items():
        drawn = draw()
        if sys.argv[1:] == ["--check"]:
            if (IMAGES / name).read_text(encoding="utf-8") != drawn:
                raise SystemExit(f"error: docs/images/{name} is not what docs/site/figures.py draws: run it")
        else:
            (IMAGES / name).write_text(drawn, encoding="utf-8")


if __name__ == "__main__":
    main()
