"""Solid textures: a number t in [0, 1] for each place."""

import numpy as np

from .skeletons import across, dot, unit


# Octave k has the seed of the first one and k times this.
GOLDEN = 0x9E3779B9


def hashed(x, y, z, seed):
    """Jenkins' one-at-a-time hash of three whole numbers, x shifted by the seed: its upper 23 bits."""
    with np.errstate(over="ignore"):
        h = np.zeros(x.shape, np.uint32)
        for word in (x + seed, y, z):
            h = h + word.astype(np.int64).astype(np.uint32)
            h = h + (h << np.uint32(10))
            h = h ^ (h >> np.uint32(6))
        h = h + (h << np.uint32(3))
        h = h ^ (h >> np.uint32(11))
        h = h + (h << np.uint32(15))
    return (h >> np.uint32(9)) / 2.0**23


def one_octave(p, seed):
    low = np.floor(p)
    t = p - low
    t = t * t * (3 - 2 * t)
    total = 0.0
    for corner in range(8):
        step = [(corner >> k) & 1 for k in range(3)]
        weight = 1.0
        for k in range(3):
            weight = weight * (t[k] if step[k] else 1 - t[k])
        total = total + weight * hashed(*[low[k] + step[k] for k in range(3)], seed)
    return total


def noise(p, scale, octaves, seed):
    octaves = min(max(octaves, 1.0), 8.0)
    seed = int(np.sign(seed) * np.floor(abs(seed) + 0.5))
    total, weights, k = 0.0, 0.0, 0
    while k < octaves:
        weight = 0.5**k * min(1.0, octaves - k)
        total = total + weight * one_octave(p * (2.0**k / scale), seed + k * GOLDEN)
        weights += weight
        k += 1
    return total / weights


def wave(x):
    """From 0 to 1 and back, smoothly: 3 t^2 - 2 t^3 of a zigzag."""
    t = 1.0 - np.abs(2.0 * (x - np.floor(x)) - 1.0)
    return t * t * (3.0 - 2.0 * t)


def pattern(par, p):
    how = par["how"]
    if how == "checker":
        return np.mod(np.floor(p / par["size"]).sum(0), 2)
    if how == "stripes":
        return np.mod(np.floor(dot(unit(par["along"]), p) / par["width"]), 2)
    if how == "gradient":
        a = np.asarray(par["from"], float)
        along = np.asarray(par["to"], float) - a
        if along @ along == 0:
            return np.zeros(p.shape[1])
        return np.clip(dot(along, p - a[:, None]) / (along @ along), 0, 1)
    if how == "noise":
        return noise(p, par["size"], par["octaves"], par["seed"])
    turbulence = par["turbulence"] * noise(p, par["size"], 3.0, par["seed"])
    n = unit(par["along"])
    distance = across(p, n)[1] if how == "rings" else dot(n, p)
    return wave(distance / par["width"] + turbulence)
