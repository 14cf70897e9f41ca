"""Falloffs: g of s = r^2 and r, r the distance over the support radius."""

import numpy as np

from . import dual as D

WORDS = {
    "soft": "soft", "geoff": "soft",
    "wyvill": "wyvill", "cubic": "wyvill", "galin": "wyvill", "blender": "wyvill",
    "quartic": "quartic", "murakami": "quartic", "pov": "quartic",
    "metaball": "metaball", "nishimura": "metaball", "links": "metaball",
    "hermite": "hermite", "hart": "hermite", "smoothstep": "hermite",
    "quintic": "quintic", "smootherstep": "quintic",
    "linear": "linear", "cone": "linear",
    "degree": "degree", "stolte": "degree",
    "blinn": "blinn", "gaussian": "blinn", "blobby": "blinn",
    "arctan": "arctan", "atan": "arctan",
    "inverse_power": "inverse_power", "inverse": "inverse_power", "lorentz": "inverse_power",
    "blanc": "blanc", "schlick": "blanc",
}

DEFAULTS = {
    "degree": {"exponent": None},
    "blinn": {"hardness": 2.0, "cutoff": 2.0, "edge": "smooth"},
    "arctan": {"stiffness": 50.0, "edge": "exact"},
    "inverse_power": {"exponent": 2.0, "cutoff": 4.0, "edge": "smooth"},
    "blanc": {"hardness": 0.0},
}


def inside(name, numbers, s, r):
    """The formula for r < 1."""
    u = 1.0 - s
    if name == "soft":
        return u * u * (5.0 + 4.0 * u) / 9.0
    if name == "wyvill":
        return u * u * u
    if name == "quartic":
        return u * u
    if name == "metaball":
        return D.where(r.v <= 1 / 3, 1.0 - 3.0 * s, 1.5 * D.square(1.0 - r))
    if name == "hermite":
        return 1.0 - 3.0 * s + 2.0 * s * r
    if name == "quintic":
        return 1.0 - s * r * (10.0 - 15.0 * r + 6.0 * s)
    if name == "linear":
        return 1.0 - r
    if name == "degree":
        return D.power(u, numbers["exponent"])
    if name == "blanc":
        p = numbers["hardness"]
        near = 1.0 - 9.0 * s * s / (p + (4.5 - 4.0 * p) * s)
        far = D.square(1.0 - s) / (0.75 - p + (1.5 + 4.0 * p) * s)
        return D.where(s.v <= 0.25, near, far)
    if name == "blinn":
        g = D.exp(-numbers["hardness"] * numbers["cutoff"] ** 2 * s)
    elif name == "arctan":
        p = numbers["stiffness"]
        g = 0.5 + D.atan(p * (1.0 - 2.0 * r)) / (2.0 * np.arctan(p))
    elif name == "inverse_power":
        n = numbers["exponent"]
        scaled = numbers["cutoff"] ** n
        g = 1.0 / (1.0 + scaled * (D.power(s, n / 2.0) if n >= 2 else D.power(r, n)))
    else:
        raise ValueError(name)
    if numbers["edge"] == "smooth":
        z = 2.0 * (1.0 - s)
        faded = g * (1.0 - D.square(1.0 - z * z))
        g = D.where(s.v >= 0.5, faded, g)
    return g


def value(name, numbers, s, r=None):
    """g, exactly 0 from r = 1 outwards."""
    if r is None:
        r = D.sqrt(s)
    return D.where(s.v < 1.0, inside(name, numbers, s, r), D.constant(0.0, s))


def level(name, numbers, wanted):
    """The s at which g has a wanted value in (0, 1), by halving: g falls monotonically."""
    low, high = 0.0, 1.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        s = D.Dual(np.array([middle]), np.zeros((1, 1)))
        if value(name, numbers, s).v[0] >= wanted:
            low = middle
        else:
            high = middle
    return low
