"""Dual numbers for forward differentiation: N values with K derivatives each."""

import numpy as np


class Dual:
    """v has the shape (N,), d the shape (K, N)."""

    __slots__ = ("v", "d")
    __array_priority__ = 1000

    def __init__(self, v, d):
        self.v = v
        self.d = d

    def __add__(self, other):
        if isinstance(other, Dual):
            return Dual(self.v + other.v, self.d + other.d)
        return Dual(self.v + other, self.d)

    __radd__ = __add__

    def __neg__(self):
        return Dual(-self.v, -self.d)

    def __sub__(self, other):
        return self + (-other)

    def __rsub__(self, other):
        return (-self) + other

    def __mul__(self, other):
        if isinstance(other, Dual):
            return Dual(self.v * other.v, self.d * other.v + other.d * self.v)
        return Dual(self.v * other, self.d * other)

    __rmul__ = __mul__

    def __truediv__(self, other):
        if isinstance(other, Dual):
            return self * reciprocal(other)
        return self * (1.0 / other)

    def __rtruediv__(self, other):
        return reciprocal(self) * other


def constant(value, like):
    """A number, or an array of N, whose derivatives are 0."""
    return Dual(np.zeros_like(like.v) + value, np.zeros_like(like.d))


def seed(values):
    """K independent variables: the derivative of variable k by k is 1."""
    values = np.asarray(values, float)
    out = []
    for k in range(len(values)):
        d = np.zeros(values.shape)
        d[k] = 1.0
        out.append(Dual(values[k].copy(), d))
    return out


def chain(x, value, slope):
    """A function of x with this value and this derivative; no derivative may be infinite."""
    slope = np.where(np.isfinite(slope), slope, 0.0)
    return Dual(value, x.d * slope)


def where(mask, a, b):
    return Dual(np.where(mask, a.v, b.v), np.where(mask, a.d, b.d))


def reciprocal(x):
    """1 / x, and 0 for x = 0."""
    zero = x.v == 0
    r = np.where(zero, 0.0, 1.0 / np.where(zero, 1.0, x.v))
    return chain(x, r, -r * r)


def sqrt(x):
    """0 for what is negative; the derivative at 0 is 0."""
    v = np.sqrt(np.maximum(x.v, 0.0))
    safe = np.where(v > 0, v, 1.0)
    return chain(x, v, np.where(v > 0, 0.5 / safe, 0.0))


def square(x):
    return x * x


def power(x, y):
    """x^y of a number y; what is negative counts as 0."""
    base = np.maximum(x.v, 0.0)
    safe = np.where(base > 0, base, 1.0)
    v = np.where(base > 0, safe**y, 1.0 if y == 0 else 0.0)
    return chain(x, v, np.where(base > 0, y * safe ** (y - 1.0), 1.0 if y == 1 else 0.0) * (x.v >= 0))


def power_dual(x, y):
    """x^y of two variables; what is negative counts as 0."""
    base = np.maximum(x.v, 0.0)
    positive = base > 0
    safe = np.where(positive, base, 1.0)
    v = np.where(positive, safe**y.v, np.where(y.v == 0, 1.0, 0.0))
    by_x = np.where(positive, y.v * safe ** (y.v - 1.0), 0.0)
    by_y = np.where(positive, v * np.log(safe), 0.0)
    return Dual(v, x.d * by_x + y.d * by_y)


def whole_power(x, n):
    """x^n by products, for a whole n of any sign."""
    v = x.v ** float(abs(n))
    r = chain(x, v, abs(n) * x.v ** float(abs(n) - 1))
    return reciprocal(r) if n < 0 else r


def exp(x):
    v = np.exp(np.minimum(x.v, 700.0))
    return chain(x, v, v)


def ln(x):
    tiny = 2.0**-126
    base = np.maximum(x.v, tiny)
    return chain(x, np.log(base), np.where(x.v > tiny, 1.0 / base, 0.0))


def sin(x):
    return chain(x, np.sin(x.v), np.cos(x.v))


def cos(x):
    return chain(x, np.cos(x.v), -np.sin(x.v))


def tan(x):
    v = np.tan(x.v)
    return chain(x, v, 1.0 + v * v)


def asin(x):
    c = np.clip(x.v, -1.0, 1.0)
    inside = np.abs(x.v) < 1.0
    return chain(x, np.arcsin(c), np.where(inside, 1.0 / np.sqrt(np.where(inside, 1 - c * c, 1.0)), 0.0))


def acos(x):
    return np.pi / 2 - asin(x)


def atan(x):
    return chain(x, np.arctan(x.v), 1.0 / (1.0 + x.v * x.v))


def atan2(y, x):
    v = np.arctan2(y.v, x.v)
    n = x.v * x.v + y.v * y.v
    zero = n == 0
    n = np.where(zero, 1.0, n)
    v = np.where(zero, 0.0, v)
    return Dual(v, np.where(zero, 0.0, y.d * (x.v / n) - x.d * (y.v / n)))


def absolute(x):
    return chain(x, np.abs(x.v), np.sign(x.v))


def sign(x):
    return chain(x, np.sign(x.v), np.zeros_like(x.v))


def floor(x):
    return chain(x, np.floor(x.v), np.zeros_like(x.v))


def ceil(x):
    return chain(x, np.ceil(x.v), np.zeros_like(x.v))


def rounded(x):
    return chain(x, np.round(x.v), np.zeros_like(x.v))


def modulo(x, y):
    """At least 0 and below the magnitude of y; 0 by 0."""
    size = absolute(y)
    zero = size.v == 0
    whole = np.floor(x.v / np.where(zero, 1.0, size.v))
    return where(zero, constant(0.0, x), x - size * whole)


def minimum(a, b):
    """Of equals the first."""
    return where(b.v < a.v, b, a)


def maximum(a, b):
    return where(b.v > a.v, b, a)


def at_least(x, low):
    return maximum(x, constant(low, x))


def at_most(x, high):
    return minimum(x, constant(high, x))


def length(parts):
    total = parts[0] * parts[0]
    for part in parts[1:]:
        total = total + part * part
    return sqrt(total)
