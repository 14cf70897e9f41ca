"""Maps and warps: from the point that is asked to the place where the child answers."""

import numpy as np

from . import dual as D
from .skeletons import unit

# With axis z the directions across are x and y, with x they are y and z, with y z and x.
ORDER = {"z": (0, 1, 2), "x": (1, 2, 0), "y": (2, 0, 1)}


def rotation(axis, angle):
    """Right-handed, about an axis of any length (Rodrigues)."""
    x, y, z = unit(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


def matrix(node):
    """The linear part and the shift of an affine map, from child to parent."""
    par, kind = node.par, node.kind
    linear, shift = np.eye(3), np.zeros(3)
    if kind == "translate":
        shift = np.asarray(par["by"], float)
    elif kind == "rotate":
        linear = rotation(par["axis"], par["angle"])
    elif kind == "scale":
        linear = np.diag(np.asarray(par["by"], float))
    elif kind == "reflect":
        n = unit(par["axis"])
        linear = np.eye(3) - 2 * np.outer(n, n)
    elif kind == "stretch":
        n = unit(par["axis"])
        linear = np.eye(3) + (par["by"] - 1) * np.outer(n, n)
    elif kind == "shear":
        linear = np.eye(3) + np.outer(np.asarray(par["by"], float), unit(par["axis"]))
    elif kind == "affine":
        rows = np.asarray(par["rows"], float).reshape(3, 4)
        linear, shift = rows[:, :3], rows[:, 3]
    return linear, shift


def apply(linear, shift, p):
    return [p[0] * linear[i, 0] + p[1] * linear[i, 1] + p[2] * linear[i, 2] + shift[i] for i in range(3)]


def affine(node, p):
    linear, shift = matrix(node)
    inverse = np.linalg.inv(linear)
    return apply(inverse, -inverse @ shift, p)


def turned(x, y, angle):
    """Turns (x, y) by an angle; all are dual."""
    c, s = D.cos(angle), D.sin(angle)
    return c * x - s * y, s * x + c * y


def on_axis(rule):
    """A rule of (first across, second across, along), for any axis."""
    def warp(par, p):
        order = ORDER[par["axis"]]
        moved = rule(par, *[p[k] for k in order])
        out = [None] * 3
        for k, value in zip(order, moved):
            out[k] = value
        return out
    return warp


def twist(par, x, y, h):
    x, y = turned(x, y, -par["rate"] * h)
    return x, y, h


def taper(par, x, y, h):
    t = D.at_most(D.at_least((h - par["from"]) / (par["to"] - par["from"]), 0.0), 1.0)
    factor = D.at_least(par["start"] + (par["end"] - par["start"]) * t, 2.0**-16)
    return x / factor, y / factor, h


def bend(par, y, z, x):
    """The spine runs along y, and bends towards z; x is the axis."""
    k, y0 = par["rate"], par["center"]
    if k == 0:
        return y, z, x
    sign = np.sign(k)
    from_y, from_z = y - y0, z - 1.0 / k
    angle = D.atan2(sign * from_y, -sign * from_z)
    ends = sorted((k * (par["from"] - y0), k * (par["to"] - y0)))
    t = D.at_most(D.at_least(angle, ends[0]), ends[1])
    spine = t * (1.0 / k) + y0
    c, s = D.cos(t), D.sin(t)
    return spine + from_y * c + from_z * s, 1.0 / k - from_y * s + from_z * c, x


def mirror(par, x, y, h):
    return x, y, D.absolute(h)


def repeat(par, x, y, h):
    k = np.round(h.v / par["spacing"])
    count = int(par["count"])
    if count > 0:
        k = np.clip(k, 0, count - 1)
    return x, y, h - D.constant(k * par["spacing"], h)


def repeat_around(par, x, y, h):
    step = 2 * np.pi / int(par["count"])
    k = np.round(np.arctan2(y.v, x.v) / step)
    x, y = turned(x, y, D.constant(-k * step, h))
    return x, y, h


def space_map(par, p):
    to, start = np.asarray(par["to"], float), np.asarray(par["from"], float)
    t = D.length([p[i] - to[i] for i in range(3)]) / par["radius"]
    u = D.at_least(1.0 - t, 0.0)
    f = u * u * u / (1.0 + t)
    return [p[i] - f * (to[i] - start[i]) for i in range(3)]


def deform(par, p):
    linear = rotation(par["axis"], np.radians(par["degrees"])) @ np.diag(np.asarray(par["size"], float))
    center = np.asarray(par["center"], float)
    inverse = np.linalg.inv(linear)
    return apply(inverse, center - inverse @ (center + np.asarray(par["by"], float)), p)


WARPS = {"twist": on_axis(twist), "taper": on_axis(taper), "bend": on_axis(bend), "mirror": on_axis(mirror),
         "repeat": on_axis(repeat), "repeat_around": on_axis(repeat_around), "space_map": space_map,
         "deform": deform}
