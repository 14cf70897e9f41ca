"""Programs of instructions (`.vm`): a line is a name, an operation, and names of lines before it."""

import numpy as np

from . import dual as D
from . import formulas
from .formulas import SceneError
from .text import Group, Node, Scene

ONE = {"neg", "abs", "recip", "sqrt", "square", "floor", "ceil", "round", "sin", "cos", "tan", "asin", "acos",
       "atan", "exp", "ln", "log", "not"}
TWO = {"add", "sub", "mul", "div", "pow", "min", "max", "mod", "atan2", "compare", "and", "or"}


def read(text):
    lines, known = [], set()
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        name, op, args = words[0], words[1], words[2:]
        count = 1 if op in ONE or op == "const" else 2 if op in TWO else 0
        if op not in ONE | TWO | {"const", "var-x", "var-y", "var-z"} or len(args) != count:
            raise SceneError(f"line {number}: {line}")
        if op != "const" and not set(args) <= known:
            raise SceneError(f"line {number}: no such line")
        known.add(name)
        lines.append((name, op, args))
    root = Node("program", {"lines": lines})
    return Scene(0.5, {"color": Group("color", 3, [1.0, 1.0, 1.0])}, root, {})


def apply(op, args, literals):
    if op in formulas.ONE:
        return formulas.ONE[op](args[0])
    if op in ("min", "max", "mod", "atan2"):
        return formulas.call(op, args)
    a, b = args[0], args[-1]
    if op == "neg":
        return -a
    if op == "recip":
        return D.reciprocal(a)
    if op == "log":
        return D.ln(a)
    if op == "not":
        return D.constant(np.where(a.v == 0, 1.0, 0.0), a)
    if op == "add":
        return a + b
    if op == "sub":
        return a - b
    if op == "mul":
        return a * b
    if op == "div":
        return a / b
    if op == "pow":
        return formulas.power(a, b, literals[-1])
    if op == "compare":
        return D.constant(np.sign(a.v - b.v), a)
    if op == "and":
        return D.where(a.v == 0, a, b)
    return D.where(a.v == 0, b, a)


def value(lines, p):
    """The value of the last line."""
    known, literals = {}, {}
    for name, op, args in lines:
        if op == "const":
            known[name] = D.constant(float(args[0]), p[0])
            literals[name] = float(args[0])
        elif op.startswith("var-"):
            known[name] = p["xyz".index(op[-1])]
        else:
            result = apply(op, [known[a] for a in args], [literals.get(a) for a in args])
            known[name] = formulas.shortened(result)
    return known[lines[-1][0]]
