"""Formulas: trees of operations over dual numbers, and the same functions of plain numbers."""

import math

import numpy as np

from . import dual as D
from . import falloffs

LARGEST = 2.0**100


class SceneError(Exception):
    pass


FUNCTIONS = {
    "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "abs", "sign", "floor", "ceil", "round",
    "mod", "exp", "ln", "square", "min", "max", "clamp", "mix", "step", "length", "pow",
}

ONE = {
    "sqrt": D.sqrt, "sin": D.sin, "cos": D.cos, "tan": D.tan, "asin": D.asin, "acos": D.acos, "atan": D.atan,
    "abs": D.absolute, "sign": D.sign, "floor": D.floor, "ceil": D.ceil, "round": D.rounded, "exp": D.exp,
    "ln": D.ln, "square": D.square,
}


def literal(tree, names):
    """The value of a tree of numbers and of definitions that are numbers, or None."""
    kind = tree[0]
    if kind == "num":
        return tree[1]
    if kind == "name":
        value = names.get(tree[1], math.pi if tree[1] == "pi" else None)
        return value.value if isinstance(value, Known) else value if tree[1] == "pi" else None
    if kind == "neg":
        inner = literal(tree[1], names)
        return None if inner is None else -inner
    if kind == "call":
        args, op = tree[2], tree[1]
    elif kind in "+-*/^":
        args, op = tree[1:], kind
    else:
        return None
    args = [literal(a, names) for a in args]
    return None if None in args else plain(op, args)


class Known:
    """A definition that is a number."""

    def __init__(self, value):
        self.value = value


def plain(op, args):
    """An operation on plain numbers."""
    try:
        if op == "+":
            return args[0] + args[1]
        if op == "-":
            return args[0] - args[1]
        if op == "*":
            return args[0] * args[1]
        if op == "/":
            return args[0] / args[1]
        if op in ("^", "pow"):
            result = args[0] ** args[1]
            if isinstance(result, complex):
                raise SceneError("a root of a negative number")
            return result
        duals = [D.Dual(np.array([float(a)]), np.zeros((1, 1))) for a in args]
        return float(call(op, duals).v[0])
    except (ZeroDivisionError, OverflowError):
        raise SceneError(f"no finite number: {op}")


def call(name, args):
    """A function of dual numbers."""
    if name in ONE:
        (x,) = args
        return ONE[name](x)
    if name == "atan2":
        return D.atan2(*args)
    if name == "mod":
        return D.modulo(*args)
    if name in ("min", "max"):
        best = args[0]
        for other in args[1:]:
            best = (D.minimum if name == "min" else D.maximum)(best, other)
        return best
    if name == "clamp":
        x, low, high = args
        return D.minimum(D.maximum(x, low), high)
    if name == "mix":
        a, b, t = args
        return a + (b - a) * t
    if name == "step":
        edge, x = args
        return D.constant(np.where(x.v < edge.v, 0.0, 1.0), x)
    if name == "length":
        return D.length(args)
    raise SceneError(f"unknown function {name}")


def power(x, exponent, n):
    if n is not None and n == int(n) and n != 0 and abs(n) <= 1024:
        return D.whole_power(x, int(n))
    if n is not None:
        return D.power(x, n)
    return D.power_dual(x, exponent)


class Rounding:
    """Whether results of formulas are rounded to f32, to find out where that matters."""

    on = False


def evaluate(tree, names, like, fields=None):
    """A formula; names are dual numbers or plain ones."""
    return shortened(exact(tree, names, like, fields))


def shortened(x):
    return D.Dual(np.float32(x.v).astype(float), np.float32(x.d).astype(float)) if Rounding.on else x


def exact(tree, names, like, fields):
    kind = tree[0]
    if kind == "num":
        return D.constant(tree[1], like)
    if kind == "name":
        if tree[1] == "pi" and "pi" not in names:
            return D.constant(math.pi, like)
        value = names[tree[1]]
        if isinstance(value, Known):
            value = value.value
        return value if isinstance(value, D.Dual) else D.constant(value, like)
    if kind == "field":
        return fields[tree[1]]
    if kind == "neg":
        return -evaluate(tree[1], names, like, fields)
    if kind == "falloff":
        d = D.at_least(evaluate(tree[3], names, like, fields), 0.0)
        return falloffs.value(tree[1], tree[2], d * d, d)
    if kind == "call":
        args = [evaluate(a, names, like, fields) for a in tree[2]]
        if tree[1] == "pow":
            return power(args[0], args[1], literal(tree[2][1], names))
        return call(tree[1], args)
    a = evaluate(tree[1], names, like, fields)
    b = evaluate(tree[2], names, like, fields)
    if kind == "+":
        return a + b
    if kind == "-":
        return a - b
    if kind == "*":
        return a * b
    if kind == "/":
        return a / b
    if kind == "^":
        return power(a, b, literal(tree[2], names))
    raise SceneError(kind)


def block(definitions, results, names, like, fields=None):
    """Definitions, then the formulas after them."""
    names = dict(names)
    for name, tree in definitions:
        number = literal(tree, names)
        names[name] = evaluate(tree, names, like, fields) if number is None else Known(number)
    return [evaluate(tree, names, like, fields) for tree in results]


def kept(x, largest=LARGEST):
    """A field within 2^100."""
    return D.at_most(D.at_least(x, -largest), largest)


def fields_of(definitions, results):
    """The names of the subtrees that a formula asks for, in order."""
    found = []

    def walk(tree):
        if tree[0] == "field":
            if tree[1] not in found:
                found.append(tree[1])
            return
        for part in tree[1:]:
            if isinstance(part, tuple):
                walk(part)
            elif isinstance(part, list):
                for inner in part:
                    walk(inner)

    for _, tree in definitions:
        walk(tree)
    for tree in results:
        walk(tree)
    return found
