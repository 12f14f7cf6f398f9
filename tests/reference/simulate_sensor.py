"""Naive twin of the simulated sensor: pixel by pixel, as the docstring of the kernel says it."""

import math


def disturbed(depth, dark, x, y, normal, uniform, sensor):
    """Depth as delivered, 0 where there is no return, as nested lists."""
    height, width = depth.shape
    return [
        [pixel(depth, dark, x, y, normal, uniform, sensor, v, u) for u in range(width)] for v in range(height)
    ]


def pixel(depth, dark, x, y, normal, uniform, sensor, v, u):
    z = float(depth[v, u])
    if math.isinf(z):
        return 0.0
    sides, smooth = [], []
    for a, b in opposite_neighbours(depth, v, u):
        # a plane's inverse depth is linear over the image; a step bends it
        bend = abs(1 / a - 2 / z + 1 / b) * z * z
        (sides if bend > 0.05 else smooth).append((a, b))
    lost = sensor.missing + (sensor.dark_missing if dark[v, u] else 0)
    if any(abs(b - a) / (2 * z) > sensor.grazed for a, b in smooth):
        lost += sensor.grazing_missing
    number = int(uniform[v, u])
    decides, mixes = number % 65536 / 65536, number // 65536 / 65536
    if decides >= 1 - lost:
        return 0.0
    if sides and decides < sensor.flying:
        near, far = min(z, *(min(pair) for pair in sides)), max(z, *(max(pair) for pair in sides))
        if far < 1e4:
            z = near + mixes * (far - near)
    if sensor.radial:
        z *= math.sqrt(1 + float(x[v, u]) ** 2 + float(y[v, u]) ** 2)
    sigma = sensor.constant + sensor.linear * z + sensor.quadratic * max(z - sensor.offset, 0) ** 2
    z += float(normal[v, u]) * sigma
    return z if z > 0 and sensor.least <= z <= sensor.greatest else 0.0


def opposite_neighbours(depth, v, u):
    """Left and right, above and below, where both lie in the image; nothing counts as 10 km away."""
    height, width = depth.shape
    pairs = []
    if 0 < u < width - 1:
        pairs.append((depth[v, u - 1], depth[v, u + 1]))
    if 0 < v < height - 1:
        pairs.append((depth[v - 1, u], depth[v + 1, u]))
    return [(min(float(a), 1e4), min(float(b), 1e4)) for a, b in pairs]
