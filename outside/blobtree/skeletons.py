"""The nearest place of each skeleton to a point; distances are those to the nearest places."""

import numpy as np


def unit(v):
    v = np.asarray(v, float)
    return v / np.linalg.norm(v)


def column(v):
    return np.asarray(v, float)[:, None]


def dot(v, p):
    return np.tensordot(np.asarray(v, float), p, 1)


def size(p):
    return np.sqrt((p * p).sum(0))


def across(p, axis):
    """The part of p across an axis of length 1, its length, and a direction along it."""
    h = dot(axis, p)
    flat = p - column(axis) * h
    rho = size(flat)
    # On the axis any direction across it will do.
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    spare = unit(np.cross(axis, other))
    direction = np.where(rho > 0, flat / np.where(rho > 0, rho, 1.0), column(spare))
    return h, rho, direction


def segment(p, a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    along = b - a
    length = along @ along
    t = np.clip(dot(along, p - column(a)) / length, 0, 1) if length > 0 else np.zeros(p.shape[1])
    return column(a) + column(along) * t


def nearest_of(p, places):
    """The nearest of some places, and where another one is as near but for rounding."""
    distances = np.array([size(p - q) for q in places])
    order = np.argsort(distances, axis=0)
    all_places = np.array(places)
    columns = np.arange(p.shape[1])
    best = all_places[order[0], :, columns].T
    close = np.zeros(p.shape[1], bool)
    for k in range(len(places)):
        # Squares of distances have errors of the size of the squares of the coordinates.
        near = distances[k] ** 2 - distances[order[0], columns] ** 2 < 1e-6 * (1 + (p * p).sum(0))
        close |= near & (size(places[k] - best) > 1e-5)
    return best, close


def toward(p, center, radius):
    """The place of a ball, of given centres and radii, that is nearest to p."""
    v = p - center
    d = size(v)
    outside = d > radius
    return np.where(outside, center + v * (radius / np.where(d > 0, d, 1.0)), p)


def disc(p, par):
    n, c = unit(par["normal"]), column(par["center"])
    _, rho, direction = across(p - c, n)
    return c + direction * np.minimum(rho, par["disc_radius"])


def ring_place(p, par):
    n, c = unit(par["normal"]), column(par["center"])
    _, _, direction = across(p - c, n)
    return c + direction * par["ring_radius"]


def torus(p, par):
    return toward(p, ring_place(p, par), par["tube_radius"])


def axis_of(par):
    """The axis from `from` to `to`, of length 1, and its length; equal ends: z."""
    along = np.subtract(par["to"], par["from"]).astype(float)
    length = float(np.linalg.norm(along))
    return (along / length if length > 0 else np.array([0.0, 0.0, 1.0])), length


def cylinder(p, par):
    u, length = axis_of(par)
    a = column(par["from"])
    h, rho, direction = across(p - a, u)
    return a + column(u) * np.clip(h, 0, length) + direction * np.minimum(rho, par["cylinder_radius"])


def cone(p, par):
    u, length = axis_of(par)
    r1, r2 = float(par["from_radius"]), float(par["to_radius"])
    if length == 0:
        r1 = r2 = max(r1, r2)
    a = column(par["from"])
    h, rho, direction = across(p - a, u)
    flat = np.array([h, rho, np.zeros_like(h)])
    corners = [[0, 0, 0], [0, r1, 0], [length, r2, 0], [length, 0, 0]]
    q, close = nearest_of(flat, [segment(flat, corners[k], corners[k + 1]) for k in range(3)])
    slope = (r2 - r1) / length if length > 0 else 0.0
    within = (h >= 0) & (h <= length) & (rho <= r1 + slope * h)
    q = np.where(within, flat, q)
    return a + column(u) * q[0] + direction * q[1], close & ~within


def round_cone_ball(p, a, b, r1, r2):
    """The centre and the radius of the ball that is nearest to p."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    along = b - a
    length = float(np.linalg.norm(along))
    if length <= abs(r2 - r1):
        bigger, r = (b, r2) if r2 > r1 else (a, r1)
        return column(bigger) + np.zeros_like(p), np.full(p.shape[1], float(r))
    u = along / length
    k = (r2 - r1) / length
    h, rho, _ = across(p - column(a), u)
    tau = np.clip(h + rho * k / np.sqrt(1 - k * k), 0, length)
    return column(a) + column(u) * tau, r1 + k * tau


def round_cone(p, par):
    center, radius = round_cone_ball(p, par["from"], par["to"], par["from_radius"], par["to_radius"])
    return toward(p, center, radius)


def frame_of(normal, along):
    n = unit(normal)
    along = np.asarray(along, float)
    u = unit(along - n * (along @ n))
    return u, np.cross(n, u), n


def rectangle(p, par):
    u, v, _ = frame_of(par["normal"], par["along"])
    c = column(par["center"])
    s = np.clip(dot(u, p - c), -par["half_length"], par["half_length"])
    t = np.clip(dot(v, p - c), -par["half_width"], par["half_width"])
    return c + column(u) * s + column(v) * t


def arc(p, par):
    u, v, _ = frame_of(par["normal"], par["start"])
    c, radius = column(par["center"]), par["arc_radius"]
    angle = np.radians(par["degrees"])

    def at(t):
        return c + radius * (column(u) * np.cos(t) + column(v) * np.sin(t))

    t = np.arctan2(dot(v, p - c), dot(u, p - c)) % (2 * np.pi)
    ends, close = nearest_of(p, [at(np.zeros_like(t)), at(np.full_like(t, angle))])
    return np.where(t <= angle, at(t), ends), close & (t > angle)


def helix(p, par):
    u, v, n = frame_of(par["normal"], par["start"])
    q = p - column(par["center"])
    x, y, h = dot(u, q), dot(v, q), dot(n, q)
    radius, rise = par["helix_radius"], par["pitch"] / (2 * np.pi)
    last = 2 * np.pi * par["turns"]
    h = h + 0.5 * rise * last

    def squared(t):
        return (x - radius * np.cos(t)) ** 2 + (y - radius * np.sin(t)) ** 2 + (h - rise * t) ** 2

    t = minimise(squared, 0.0, last, int(np.ceil(par["turns"] * 96)) + 2)
    # Half the second derivative of the square of the distance, along the curve.
    bending = x * radius * np.cos(t) + y * radius * np.sin(t) + rise * rise
    hard = bending < HARD * (radius * radius + rise * rise)
    place = (column(par["center"]) + column(u) * (radius * np.cos(t)) + column(v) * (radius * np.sin(t))
             + column(n) * (rise * t - 0.5 * rise * last))
    return place, hard


def minimise(squared, low, high, count):
    """For each point the place in [low, high] where a function is least: samples, then golden sections."""
    grid = np.linspace(low, high, count)
    values = np.array([squared(np.asarray(t)) for t in grid])
    step = (high - low) / (count - 1)
    order = np.argsort(values, axis=0)
    best_t, best = None, None
    # The lowest local minima of the samples.
    inner = np.full(values.shape, np.inf)
    lower = np.ones(values.shape, bool)
    lower[1:] &= values[1:] <= values[:-1]
    lower[:-1] &= values[:-1] <= values[1:]
    inner[lower] = values[lower]
    order = np.argsort(inner, axis=0)
    for k in range(min(4, count)):
        start = grid[order[k]]
        usable = np.isfinite(np.take_along_axis(inner, order[k][None], 0)[0])
        a = np.clip(start - step, low, high)
        b = np.clip(start + step, low, high)
        t = golden(squared, a, b)
        value = np.where(usable, squared(t), np.inf)
        if best is None:
            best_t, best = t, value
        else:
            less = value < best
            best_t, best = np.where(less, t, best_t), np.where(less, value, best)
    return best_t


def golden(squared, a, b):
    """Golden sections, then a few steps of Newton with differences in f64."""
    ratio = (np.sqrt(5) - 1) / 2
    low, high = a.copy(), b.copy()
    for _ in range(40):
        c = high - ratio * (high - low)
        d = low + ratio * (high - low)
        left = squared(c) < squared(d)
        low, high = np.where(left, low, c), np.where(left, d, high)
    return 0.5 * (low + high)


def half_space(p, par):
    n = unit(par["normal"])
    return p - column(n) * np.maximum(0, dot(n, p - column(par["at"])))


def triangle(p, par):
    a, b, c = (np.asarray(par[k], float) for k in "abc")
    sides, close = nearest_of(p, [segment(p, a, b), segment(p, b, c), segment(p, c, a)])
    n = np.cross(b - a, c - a)
    area = n @ n
    if area == 0:
        return sides, close
    above = np.ones(p.shape[1], bool)
    for s, e in ((a, b), (b, c), (c, a)):
        above &= dot(np.cross(n, e - s), p - column(s)) >= 0
    flat = p - column(n) * (dot(n, p - column(a)) / area)
    return np.where(above, flat, sides), close & ~above


def polygon(p, par):
    points = np.asarray(par["points"], float)
    following = np.roll(points, -1, 0)
    edges, close = nearest_of(p, [segment(p, a, b) for a, b in zip(points, following)])
    n = unit(normal_of(points))
    u, v, n = frame_of(n, np.eye(3)[int(np.argmin(np.abs(n)))])
    origin = points.mean(0)
    q = p - column(origin)
    x, y, h = dot(u, q), dot(v, q), dot(n, q)
    flat = points - origin
    ex, ey = flat @ u, flat @ v
    odd = np.zeros(p.shape[1], bool)
    for k in range(len(points)):
        j = (k + 1) % len(points)
        crosses = (ey[k] > y) != (ey[j] > y)
        if not crosses.any():
            continue
        at = ex[k] + (y - ey[k]) * (ex[j] - ex[k]) / np.where(ey[j] == ey[k], 1.0, ey[j] - ey[k])
        odd ^= crosses & (x < at)
    return np.where(odd, p - column(n) * h, edges), close & ~odd


def normal_of(points):
    """The normal of flat corners: the largest product of differences, as edges may cross."""
    best = np.zeros(3)
    for k in range(1, len(points)):
        for j in range(k + 1, len(points)):
            n = np.cross(points[k] - points[0], points[j] - points[0])
            if n @ n > best @ best:
                best = n
    return best


def radii_of(par, count):
    radii = [float(r) for r in par["radii"]]
    if len(radii) == 1:
        radii = radii * count
    return radii or [0.0] * count


def polyline(p, par):
    points = np.asarray(par["points"], float)
    radii = radii_of(par, len(points))
    pairs = [(k, k + 1) for k in range(len(points) - 1)]
    if par["closed"]:
        pairs.append((len(points) - 1, 0))
    best, least, hard = None, None, np.zeros(p.shape[1], bool)
    for i, j in pairs:
        center, radius = round_cone_ball(p, points[i], points[j], radii[i], radii[j])
        signed = size(p - center) - radius
        q = toward(p, center, radius)
        if best is None:
            best, least = q, signed
        else:
            apart = np.abs(signed - least) * (np.abs(signed) + radius)
            tie = (apart < 1e-6 * (1 + (p * p).sum(0))) & (size(q - best) > 1e-5)
            less = signed < least
            hard = np.where(tie, True, hard & ~less)
            best, least = np.where(less, q, best), np.where(less, signed, least)
    return best, hard


# How little distances may change along a curve: 1 is as along a straight line, 0 is at a centre of curvature.
HARD = 0.12


def curve(p, pieces):
    """The nearest place of cubic Bezier pieces, for each its four points and its four radii.

    And where that is hard to find: near a centre of curvature, where distances hardly change along the curve.
    """
    best, least, flat = None, None, None
    for points, radii in pieces:
        points, radii = np.asarray(points, float), np.asarray(radii, float)

        def weights(t):
            s = 1 - t
            return s**3, 3 * s * s * t, 3 * s * t * t, t**3

        def center(t):
            return sum(column(points[k]) * w for k, w in enumerate(weights(t)))

        def radius(t):
            return sum(radii[k] * w for k, w in enumerate(weights(t)))

        def signed(t):
            t = np.broadcast_to(t, p.shape[1:])
            return size(p - center(t)) - radius(t)

        t = minimise(signed, 0.0, 1.0, 49)
        value = signed(t)
        q = toward(p, center(t), radius(t))
        h = 1e-3
        speed = size(center(t + h) - center(t - h)) / (2 * h)
        bending = (signed(t + h) + signed(t - h) - 2 * value) / (h * h)
        hard = bending * size(p - center(t)) < HARD * speed * speed
        if best is None:
            best, least, flat = q, value, hard
        else:
            less = value < least
            best, least = np.where(less, q, best), np.where(less, value, least)
            flat = np.where(less, hard, flat)
    return best, flat


def bezier(p, par):
    points = par["points"]
    radii = radii_of(par, len(points))
    pieces = [(points[k:k + 4], radii[k:k + 4]) for k in range(0, len(points) - 1, 3)]
    return curve(p, pieces)


def catmull_rom(p, par):
    points = np.asarray(par["points"], float)
    radii = np.array(radii_of(par, len(points)))
    count = len(points)

    def tangents(values):
        if par["closed"]:
            return (np.roll(values, -1, 0) - np.roll(values, 1, 0)) / 2
        result = np.zeros_like(values)
        result[1:-1] = (values[2:] - values[:-2]) / 2
        result[0] = values[1] - values[0]
        result[-1] = values[-1] - values[-2]
        return result

    m = tangents(points)
    mr = np.clip(tangents(radii), -3 * radii, 3 * radii)
    pieces = []
    for i in range(count if par["closed"] else count - 1):
        j = (i + 1) % count
        pieces.append(([points[i], points[i] + m[i] / 3, points[j] - m[j] / 3, points[j]],
                       [radii[i], radii[i] + mr[i] / 3, radii[j] - mr[j] / 3, radii[j]]))
    return curve(p, pieces)


PLACES = {
    "point": lambda p, par: column(par["at"]) + np.zeros_like(p),
    "segment": lambda p, par: segment(p, par["from"], par["to"]),
    "disc": disc,
    "ring": ring_place,
    "cylinder": cylinder,
    "box": lambda p, par: column(par["center"]) + np.clip(p - column(par["center"]), -column(par["half"]),
                                                         column(par["half"])),
    "sphere": lambda p, par: toward(p, column(par["center"]), par["sphere_radius"]),
    "torus": torus,
    "round_cone": round_cone,
    "rectangle": rectangle,
    "half_space": half_space,
}

# The same for those that tell where it is hard to say which place is the nearest.
HARDER = {"triangle": triangle, "cone": cone, "arc": arc, "polyline": polyline, "polygon": polygon,
          "helix": helix, "bezier": bezier, "catmull_rom": catmull_rom}


# uv: where the nearest place is on the skeleton.

def turn(p, axis):
    """The angle about an axis as a part of a turn, in [0, 1)."""
    axis = unit(axis)
    first = np.array([1.0, 0, 0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1, 0])
    u = unit(first - axis * (first @ axis))
    v = np.cross(axis, u)
    return (np.arctan2(dot(v, p), dot(u, p)) / (2 * np.pi)) % 1.0


def uv_point(p, par):
    v = p - column(par["at"])
    d = size(v)
    latitude = np.arcsin(np.clip(v[2] / np.where(d > 0, d, 1.0), -1, 1))
    return turn(v, [0, 0, 1]), 0.5 + latitude / np.pi


def uv_along(p, par):
    u, length = axis_of(par)
    q = p - column(par["from"])
    return turn(q, u), np.clip(dot(u, q) / length, 0, 1) if length > 0 else np.zeros(p.shape[1])


def uv_disc(p, par):
    q = p - column(par["center"])
    _, rho, _ = across(q, unit(par["normal"]))
    radius = par["disc_radius"]
    return turn(q, par["normal"]), np.minimum(rho / radius, 1) if radius > 0 else np.zeros_like(rho)


def uv_ring(p, par):
    q = p - column(par["center"])
    h, rho, _ = across(q, unit(par["normal"]))
    around = (np.arctan2(h, rho - par["ring_radius"]) / (2 * np.pi)) % 1.0
    return turn(q, par["normal"]), around


def uv_box(p, par):
    q = p - column(par["center"])
    half = column(par["half"])
    # The face: the one that the point is farthest out of.
    face = np.argmax(np.abs(q) - half, axis=0)
    s = np.clip(q, -half, half) / np.where(half > 0, half, 1.0)
    side = np.sign(np.take_along_axis(q, face[None], 0)[0])
    u = np.choose(face, [side * s[1], -side * s[0], side * s[0]])
    v = np.choose(face, [s[2], s[2], s[1]])
    return 0.5 + 0.5 * u, 0.5 + 0.5 * v


def uv_triangle(p, par):
    """The weights of the place in its plane below the point, each kept in [0, 1]."""
    a, b, c = (np.asarray(par[k], float) for k in "abc")
    weights = np.linalg.pinv(np.stack([b - a, c - a], 1)) @ (p - column(a))
    return np.clip(weights[0], 0, 1), np.clip(weights[1], 0, 1)


def middle(par):
    """What the uv of all other skeletons is around."""
    if "points" in par:
        points = np.asarray(par["points"], float)
        return 0.5 * (points.min(0) + points.max(0))
    if "from" in par:
        return 0.5 * np.add(par["from"], par["to"])
    if "pitch" in par:
        n = unit(par["normal"])
        return np.asarray(par["center"], float) - 0.5 * par["pitch"] * par["turns"] * n
    return par.get("center", par.get("at", np.zeros(3)))


def uv_other(p, par):
    """Longitude and latitude, as those of a point in the middle."""
    return uv_point(p, {"at": middle(par)})


UV = {"point": uv_point, "segment": uv_along, "cylinder": uv_along, "disc": uv_disc, "ring": uv_ring,
      "box": uv_box, "triangle": uv_triangle}
