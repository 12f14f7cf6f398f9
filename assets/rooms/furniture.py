"""What stands and hangs in an intervention room: table, cabinets, an open shelf, monitors, lamp, drape, lines."""

from itertools import pairwise

import numpy as np
from modelling import Parts, placed

HALF, CEILING, THICK = 2.05, 2.9, 0.2
TOP = 0.95
WHITE, STEEL, DARK = (0.80, 0.80, 0.78), (0.45, 0.47, 0.50), (0.02, 0.02, 0.022)


def shell() -> None:
    """Floor, four walls, ceiling: boxes just outside the watched space of 4 x 4 m."""
    a, b, c, t = HALF, HALF + THICK, CEILING, THICK
    Parts().box((-b, -b, -t), (b, b, 0)).solid("floor", (0.38, 0.42, 0.45))
    wall = (0.62, 0.70, 0.70)
    Parts().box((-b, -b, 0), (-a, b, c)).solid("wall -x", wall)
    Parts().box((a, -b, 0), (b, b, c)).solid("wall +x", wall)
    Parts().box((-a, -b, 0), (a, -a, c)).solid("wall -y", wall)
    Parts().box((-a, a, 0), (a, b, c)).solid("wall +y", wall)
    Parts().box((-b, -b, c), (b, b, c + t)).solid("ceiling", (0.8, 0.8, 0.8))


def table() -> None:
    """Patient table: top with rails and mattress, column, foot, a control box on the rail."""
    frame = Parts()
    frame.box((-0.45, -0.23, TOP - 0.06), (1.55, 0.23, TOP), bevel=0.012)
    frame.box((-0.2, 0.235, TOP - 0.05), (1.5, 0.25, TOP - 0.02)).box(
        (-0.2, -0.25, TOP - 0.05), (1.5, -0.235, TOP - 0.02)
    )
    for x in (-0.1, 0.45, 0.95, 1.4):
        for y in (0.22, -0.24):
            frame.box((x, y, TOP - 0.045), (x + 0.03, y + 0.02, TOP - 0.025))
    frame.box((0.98, -0.14, 0.05), (1.28, 0.14, TOP - 0.05), bevel=0.02)
    frame.box((0.92, -0.18, 0.60), (1.40, 0.18, TOP - 0.06), bevel=0.03)
    frame.box((0.72, -0.30, 0.0), (1.55, 0.30, 0.07), bevel=0.02)
    frame.solid("table", WHITE)
    Parts().box((-0.43, -0.225, TOP), (1.53, 0.225, TOP + 0.05), bevel=0.018).solid(
        "mattress", (0.06, 0.09, 0.14)
    )
    box = Parts().box((0.70, -0.31, TOP - 0.08), (0.95, -0.24, TOP + 0.06), bevel=0.01)
    for k in range(3):
        box.limb((0.75 + 0.07 * k, -0.285, TOP + 0.05), (0.75 + 0.07 * k, -0.295, TOP + 0.12), 0.009, n=8)
    box.solid("table controls", (0.25, 0.27, 0.30))


def drape(hang: float = 0.33) -> None:
    """A sheet over the patient's belly and legs: lies on them, hangs in folds at both sides of the table."""
    s = np.linspace(0.22, 1.38, 59)
    flat = 0.27
    t = np.concatenate(
        [
            np.linspace(-flat - hang, -flat, 14)[:-1],
            np.linspace(-flat, flat, 31),
            np.linspace(flat, flat + hang, 14)[1:],
        ]
    )
    surface = np.empty((len(s), len(t), 3))
    for i, x in enumerate(s):
        body = 0.235 * np.exp(-(((x - 0.30) / 0.33) ** 4)) + 0.17 / (1 + np.exp(-(x - 0.45) / 0.05))
        body = min(body, 0.245) - 0.03 * max(0.0, x - 1.0)
        for j, y in enumerate(t):
            over, side = max(0.0, abs(y) - flat), np.sign(y)
            height = (
                TOP
                + 0.066
                + body * max(0.0, 1 - (abs(y) / (flat + 0.01)) ** 4)
                + 0.004 * np.sin(23 * x + 9 * y)
            )
            if over > 0:
                wave = (0.014 + 0.05 * over) * (1 + np.sin(31 * x + 2.2 * side + 4 * over))
                surface[i, j] = (x, side * (flat + 0.012 + wave), TOP + 0.06 - over)
            else:
                surface[i, j] = (x, y, height)
    Parts().sheet(surface, 0.006).solid("drape", (0.08, 0.30, 0.34), triangles=5200)


def lead_curtain(x0: float, x1: float, y: float, outward: int) -> None:
    """Lead flaps that hang from the table's rail against scatter."""
    parts = Parts()
    for k, x in enumerate(np.arange(x0, x1 - 0.01, 0.16)):
        swing = 0.02 * np.sin(3.0 * k)
        grid = np.array(
            [
                [
                    (
                        x + 0.15 * u,
                        y + outward * (swing + 0.015 * np.sin(8 * v + k)) * v,
                        TOP - 0.05 - 0.55 * v,
                    )
                    for v in np.linspace(0, 1, 8)
                ]
                for u in np.linspace(0, 1, 4)
            ]
        )
        parts.sheet(grid, 0.008)
    parts.solid("lead curtain", (0.05, 0.07, 0.18))


def cabinet(name: str, lower, upper, *, doors: str) -> None:
    """A closed cabinet with doors and handles on the side that `doors` names, such as "-y"."""
    body = Parts().box(lower, upper, bevel=0.008)
    axis, sign = "xy".index(doors[1]), 1 if doors[0] == "+" else -1
    other = 1 - axis
    face = (upper if sign > 0 else lower)[axis]
    count = max(1, round((upper[other] - lower[other]) / 0.45))
    edges = np.linspace(lower[other] + 0.015, upper[other] - 0.015, count + 1)
    handles = Parts()
    for k, (a, b) in enumerate(pairwise(edges)):
        low, high = [0, 0, lower[2] + 0.05], [0, 0, upper[2] - 0.03]
        low[axis], high[axis] = sorted((face - 0.004 * sign, face + 0.018 * sign))
        low[other], high[other] = a + 0.004, b - 0.004
        body.box(low, high, bevel=0.004)
        at = b - 0.05 if k % 2 == 0 else a + 0.05
        ends = []
        for z in (0.55, 0.62):
            end = [0, 0, lower[2] + z * (upper[2] - lower[2])]
            end[axis], end[other] = face + 0.045 * sign, at
            root = list(end)
            root[axis] = face + 0.005 * sign
            handles.bar(root, end, 0.006, n=8)
            ends.append(end)
        handles.limb(ends[0], ends[1], 0.007, n=8)
    body.solid(name, WHITE)
    handles.solid(f"{name} handles", STEEL)


def open_shelf(x: float, y: float, heading_deg: float) -> None:
    """An open shelf of sheet metal: boards of 18 mm, boxes, bottles, rolls and a loose tube on them."""
    place = placed(x, y, heading_deg)
    frame, goods, bottles = Parts(), Parts(), Parts()
    w, d, h = 0.9, 0.36, 1.85
    for side in (-w / 2, w / 2 - 0.018):
        frame.box((0, side, 0.0), (d, side + 0.018, h))
    frame.box((0, -w / 2, 0.06), (0.008, w / 2, h))
    rng = np.random.default_rng(7)
    for z in (0.08, 0.50, 0.90, 1.28, 1.83):
        frame.box((0.004, -w / 2 + 0.01, z), (d, w / 2 - 0.01, z + 0.018))
    for z in (0.10, 0.52, 0.92, 1.30):
        at = -w / 2 + 0.06
        while at < w / 2 - 0.14:
            wide, deep, tall = rng.uniform(0.07, 0.17), rng.uniform(0.12, 0.26), rng.uniform(0.10, 0.26)
            if rng.random() < 0.62:
                goods.box((0.06, at, z), (0.06 + deep, at + wide, z + tall), bevel=0.004)
                at += wide + rng.uniform(0.01, 0.06)
            else:
                r = 0.034
                bottles.revolved(
                    [(r, 0), (r, 0.12), (0.013, 0.15), (0.013, 0.18)], (0.22, at + r, z + 0.001), n=16
                )
                at += 2 * r + rng.uniform(0.01, 0.04)
    bottles.tube([(0.3, -0.25, 1.31), (0.37, -0.24, 1.25), (0.39, -0.22, 0.95), (0.37, -0.24, 0.70)], 0.006)
    for parts, name, colour in (
        (frame, "open shelf", STEEL),
        (goods, "shelf boxes", (0.55, 0.42, 0.25)),
        (bottles, "shelf bottles", (0.25, 0.5, 0.65)),
    ):
        parts.turned(place)
        parts.solid(name, colour)


def cart(x: float, y: float, heading_deg: float) -> None:
    """A low drawer cabinet on castors, with a device and its screen on top."""
    place = placed(x, y, heading_deg)
    body = (
        Parts()
        .box((-0.25, -0.35, 0.10), (0.25, 0.35, 0.86), bevel=0.01)
        .box((-0.27, -0.37, 0.86), (0.27, 0.37, 0.89), bevel=0.006)
    )
    for k in range(4):
        z = 0.13 + 0.18 * k
        body.box((0.24, -0.33, z), (0.262, 0.33, z + 0.165), bevel=0.004)
        body.limb((0.285, -0.12, z + 0.12), (0.285, 0.12, z + 0.12), 0.007, n=8)
        body.bar((0.25, -0.1, z + 0.12), (0.285, -0.1, z + 0.12), 0.005, n=6).bar(
            (0.25, 0.1, z + 0.12), (0.285, 0.1, z + 0.12), 0.005, n=6
        )
    for sx in (-0.2, 0.2):
        for sy in (-0.3, 0.3):
            body.bar((sx, sy - 0.015, 0.045), (sx, sy + 0.015, 0.045), 0.045, n=14).bar(
                (sx, sy, 0.04), (sx, sy, 0.11), 0.012, n=8
            )
    body.turned(place)
    body.solid("cart", (0.03, 0.035, 0.05))
    device = (
        Parts()
        .box((-0.18, -0.2, 0.89), (0.15, 0.2, 1.02), bevel=0.01)
        .bar((-0.1, 0, 1.02), (-0.1, 0, 1.16), 0.02)
    )
    device.box((-0.10, -0.22, 1.12), (-0.06, 0.22, 1.42), bevel=0.008)
    device.tube(
        [
            (-0.15, 0.15, 0.95),
            (-0.27, 0.2, 0.93),
            (-0.31, 0.24, 0.6),
            (-0.30, 0.26, 0.12),
            (-0.24, 0.3, 0.01),
        ],
        0.008,
    )
    device.turned(place)
    device.solid("cart device", (0.7, 0.7, 0.66))


def monitors(x: float, y: float, heading_deg: float, *, screens: int = 3) -> None:
    """Monitor suspension: ceiling post, boom, a frame with screens, and cables in loops."""
    place = placed(x, y, heading_deg)
    frame, screen, cables = Parts(), Parts(), Parts()
    frame.bar((0, 0, CEILING), (0, 0, 2.25), 0.045, n=16).bar(
        (0, 0, CEILING), (0, 0, CEILING - 0.05), 0.11, n=20
    )
    frame.limb((0, 0, 2.30), (0, 0, 1.68), 0.032)
    half = 0.27 * screens
    frame.box((-0.03, -half, 1.64), (0.01, half, 1.70), bevel=0.008)
    frame.limb((-0.02, -half, 1.67), (-0.02, -half, 1.42), 0.012, n=8).limb(
        (-0.02, half, 1.67), (-0.02, half, 1.42), 0.012, n=8
    )
    frame.limb((-0.02, -half, 1.42), (-0.02, half, 1.42), 0.012, n=8)
    for k in range(screens):
        mid = (k - (screens - 1) / 2) * 0.54
        screen.box((0.01, mid - 0.25, 1.48), (0.05, mid + 0.25, 1.81), bevel=0.008)
        hang = 0.12 + 0.05 * k
        cables.tube(
            [
                (-0.01, mid, 1.60),
                (-0.06, mid + 0.04, 1.52 - hang),
                (-0.06, mid + 0.16, 1.50 - hang),
                (-0.03, mid + 0.2, 1.66),
            ],
            0.0075,
        )
    cables.tube([(-0.03, 0.05, 1.70), (-0.10, 0.10, 1.95), (-0.06, 0.06, 2.25), (-0.04, 0.03, 2.6)], 0.008)
    for parts, name, colour in (
        (frame, "monitor frame", WHITE),
        (screen, "monitors", (0.015, 0.015, 0.02)),
        (cables, "monitor cables", (0.03, 0.03, 0.03)),
    ):
        parts.turned(place)
        parts.solid(name, colour)


def lamp(x: float, y: float, head: tuple[float, float, float]) -> None:
    """Operating lamp: ceiling post, two arms, a dome with a sterile handle."""
    parts = (
        Parts()
        .bar((x, y, CEILING), (x, y, 2.32), 0.035, n=16)
        .bar((x, y, CEILING), (x, y, CEILING - 0.04), 0.10, n=20)
    )
    hx, hy, hz = head
    elbow = ((x + hx) / 2 + 0.12, (y + hy) / 2 + 0.12, 2.34)
    parts.limb((x, y, 2.36), elbow, 0.03).limb(elbow, (hx, hy, hz + 0.16), 0.024).limb(
        (hx, hy, hz + 0.16), (hx, hy, hz + 0.05), 0.022
    )
    parts.revolved(
        [
            (0.02, -0.05),
            (0.20, -0.05),
            (0.27, -0.02),
            (0.27, 0.0),
            (0.22, 0.045),
            (0.10, 0.075),
            (0.03, 0.09),
        ],
        head,
        n=36,
    )
    parts.limb((hx, hy, hz - 0.05), (hx, hy, hz - 0.15), 0.016, n=10)
    parts.solid("lamp", (0.85, 0.85, 0.83))


def iv_pole(
    x: float, y: float, *, height: float = 1.95, line_to: tuple[float, float, float] | None = None
) -> None:
    """Infusion stand: five legs, a pole of 25 mm, hooks, two bags, a pump, and a line of 7 mm to the patient."""
    stand = Parts()
    for k in range(5):
        a = 2 * np.pi * k / 5
        end = (x + 0.27 * np.cos(a), y + 0.27 * np.sin(a), 0.07)
        stand.limb((x, y, 0.10), end, 0.014, n=8).ball((end[0], end[1], 0.03), 0.029, u=10, v=6)
    stand.limb((x, y, 0.09), (x, y, height), 0.0125, n=10)
    for s in (1, -1):
        stand.tube(
            [
                (x, y, height - 0.02),
                (x + 0.08 * s, y, height),
                (x + 0.11 * s, y, height + 0.03),
                (x + 0.12 * s, y, height),
            ],
            0.006,
        )
    stand.solid("iv pole", STEEL)
    bags = Parts()
    for s in (1, -1):
        bags.ball((x + 0.11 * s, y, height - 0.13), (0.055, 0.022, 0.10)).bar(
            (x + 0.11 * s, y, height - 0.05), (x + 0.11 * s, y, height + 0.0), 0.008, n=8
        )
    bags.box((x + 0.005, y - 0.05, 1.22), (x + 0.11, y + 0.05, 1.42), bevel=0.01)
    bags.solid("iv bags", (0.65, 0.72, 0.72))
    if line_to is not None:
        a = np.array([x + 0.11, y, height - 0.22])
        b = np.array(line_to)
        low = np.minimum(a[2], b[2])
        path = [
            a,
            (x + 0.10, y, 1.45),
            (x + 0.06, y, 1.18),
            0.65 * np.array([x, y, low - 0.12]) + 0.35 * np.array([b[0], b[1], low - 0.12]),
            0.3 * np.array([x, y, low]) + 0.7 * np.array([b[0], b[1], low]),
            b,
        ]
        Parts().tube(path, 0.0035, n=7).solid("iv line", (0.6, 0.7, 0.75))


def floor_cables() -> None:
    """Cables of 12 and 16 mm from the table's foot to the walls, and one that hangs from its rail."""
    parts = Parts()
    parts.tube(
        [(1.5, 0.1, 0.03), (1.7, 0.3, 0.008), (1.75, 0.8, 0.008), (1.95, 1.2, 0.008), (2.04, 1.3, 0.05)],
        0.008,
    )
    parts.tube(
        [
            (1.52, -0.1, 0.03),
            (1.72, -0.4, 0.006),
            (1.6, -1.0, 0.006),
            (1.85, -1.5, 0.006),
            (2.04, -1.6, 0.05),
        ],
        0.006,
    )
    parts.tube(
        [
            (0.80, -0.27, TOP - 0.06),
            (0.78, -0.31, 0.75),
            (0.74, -0.33, 0.45),
            (0.70, -0.32, 0.25),
            (0.74, -0.29, 0.06),
        ],
        0.007,
    )
    parts.solid("cables", (0.02, 0.02, 0.02))


def hose(points, radius: float, name: str) -> None:
    """A hose or thick cable along points."""
    Parts().tube(points, radius).solid(name, (0.03, 0.03, 0.03))


def stool(x: float, y: float) -> None:
    """A round stool on five legs."""
    parts = Parts().revolved(
        [(0.02, 0.50), (0.18, 0.50), (0.19, 0.52), (0.19, 0.55), (0.17, 0.57), (0.02, 0.575)], (x, y, 0), n=28
    )
    parts.bar((x, y, 0.10), (x, y, 0.51), 0.025)
    for k in range(5):
        a = 2 * np.pi * k / 5 + 0.3
        end = (x + 0.24 * np.cos(a), y + 0.24 * np.sin(a), 0.06)
        parts.limb((x, y, 0.11), end, 0.016, n=8).ball((end[0], end[1], 0.028), 0.027, u=10, v=6)
    parts.solid("stool", (0.04, 0.05, 0.06))


def shield(x: float, y: float, angle_deg: float) -> None:
    """A lead-glass screen of 12 mm on an arm from the ceiling."""
    parts = Parts().bar((x, y, CEILING), (x, y, 2.0), 0.02, n=12)
    parts.turned(placed(0, 0, 0))
    pane = Parts().box((-0.35, -0.006, 1.25), (0.35, 0.006, 1.95), bevel=0.003)
    pane.turned(placed(x, y, angle_deg))
    parts.solid("shield arm", STEEL)
    pane.solid("shield", (0.45, 0.55, 0.50))
