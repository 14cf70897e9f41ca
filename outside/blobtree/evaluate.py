"""Field, gradient and attributes of a scene at points."""

import numpy as np

from . import dual as D
from . import falloffs, formulas, maps, programs, skeletons, textures
from .text import SKELETONS


# Operators of two children, of which more are folded from the left.
FOLDED = {"smooth_union", "smooth_intersection", "smooth_difference", "rfunction", "symmetric_difference"}


class Sample:
    """A field with its derivatives by the point, and the weights of the leaves below it.

    `weights` has for each leaf an array; they add up to 1.
    """

    def __init__(self, f, weights):
        self.f = f
        self.weights = weights
        self.nobody = False     # inside of a folded operator: where no child has a weight


class Evaluation:
    def __init__(self, scene, points):
        self.scene = scene
        self.c = scene.iso
        self.points = np.asarray(points, float).T
        self.leaves = []        # for each leaf the values of its groups
        self.known = {}         # leaves by node and place
        n = self.points.shape[1]
        self.doubt = np.zeros(n, bool)      # where rounding decides about attributes
        self.hard = np.zeros(n, bool)       # where the nearest place of a skeleton is hard to tell
        self.largest_f = np.zeros(n)
        self.largest_g = np.zeros(n)

    # The way down.

    def run(self):
        start = D.seed(self.points)
        with np.errstate(all="ignore"):
            sample = self.node(self.scene.root, start, {})
        answer = {"field": sample.f.v, "gradient": sample.f.d.T}
        for group in self.scene.groups.values():
            answer[group.name] = self.mixed(group, sample)
        return answer

    def node(self, node, p, given):
        kind = node.kind
        if kind in SKELETONS:
            sample = self.leaf(node, p, given, self.primitive(node, p))
        elif kind in ("translate", "rotate", "scale", "reflect", "stretch", "shear", "affine"):
            sample = self.node(node.children[0], maps.affine(node, p), given)
        elif kind in maps.WARPS or kind == "warp":
            sample = self.warp(node, p, given)
        elif kind == "attribute":
            sample = self.node(node.children[0], p, given | {node.par["group"]: self.values(node, p)})
        elif kind == "expression":
            sample = self.expression(node, p, given)
        elif kind == "program":
            f = formulas.kept(0.5 - programs.value(node.par["lines"], p))
            sample = self.leaf(node, p, given, f)
        elif kind == "within":
            sample = self.within(node.par["box"], p, self.node(node.children[0], p, given))
        elif kind == "falloff":
            sample = self.faded(node, self.node(node.children[0], p, given))
        elif kind == "select":
            chosen = int(np.clip(np.floor(node.par["number"] + 0.5), 0, len(node.children) - 1))
            sample = self.node(node.children[chosen], p, given)
        else:
            children = [self.node(child, p, given) for child in node.children]
            for child in children:
                child.nobody = False
            sample = self.operator(node, children)
        self.largest_f = np.maximum(self.largest_f, np.abs(sample.f.v))
        self.largest_g = np.maximum(self.largest_g, np.abs(sample.f.d).max(0))
        return sample

    # Leaves.

    def primitive(self, node, p):
        par, kind = node.par, node.kind
        if kind in ("ellipsoid", "lmetric", "superquadric"):
            q = [(p[i] - par["center"][i]) / par["stretch"][i] for i in range(3)]
            d = self.norm(kind, par, q)
        else:
            place = np.array([x.v for x in p])
            if kind in skeletons.HARDER:
                place, hard = skeletons.HARDER[kind](place, par)
                self.hard |= hard
            else:
                place = skeletons.PLACES[kind](place, par)
            d = D.length([p[i] - D.constant(place[i], p[i]) for i in range(3)])
        name, numbers = par["falloff"]
        radius = par["radius"]
        if radius is None:
            s = falloffs.level(name, numbers, self.c / par["strength"])
            radius = par["surface_radius"] / np.sqrt(s)
        r = d / radius
        return falloffs.value(name, numbers, r * r, r) * par["strength"]

    def norm(self, kind, par, q):
        """In units of the largest part, so that no power overflows."""
        if kind == "ellipsoid":
            return D.length(q)
        largest = np.max([np.abs(x.v) for x in q], axis=0)
        unit = D.constant(np.where(largest > 0, largest, 1.0), q[0])
        x, y, z = [D.absolute(part / unit) for part in q]
        if kind == "lmetric":
            e = par["exponent"]
            return D.power(D.power(x, e) + D.power(y, e) + D.power(z, e), 1 / e) * unit
        e1, e2 = par["e1"], par["e2"]
        flat = D.power(D.power(x, 2 / e2) + D.power(y, 2 / e2), e2 / e1)
        return D.power(flat + D.power(z, 2 / e1), e1 / 2) * unit

    def leaf(self, node, p, given, f):
        place = tuple(x.v.tobytes() for x in p)
        key = (id(node), place, tuple((name, id(value)) for name, value in sorted(given.items())))
        if key not in self.known:
            self.known[key] = len(self.leaves)
            self.leaves.append(self.leaf_values(node, p, given))
        return Sample(f, {self.known[key]: np.ones(f.v.shape)})

    def leaf_values(self, node, p, given):
        values = {}
        n = self.points.shape[1]
        for group in self.scene.groups.values():
            value = given.get(group.name)
            if value is None:
                value = np.tile(np.asarray(group.default, float), (n, 1))
            elif isinstance(value, dict):
                value = self.uv(node, p, value, group)
            values[group.name] = value
        return values

    def uv(self, node, p, how, group):
        place = np.array([x.v for x in p])
        u, v = skeletons.UV.get(node.kind, skeletons.uv_other)(place, node.par)
        u, v = u * how["scale"][0], v * how["scale"][1]
        angle = np.radians(how["rotate"])
        u, v = np.cos(angle) * u - np.sin(angle) * v, np.sin(angle) * u + np.cos(angle) * v
        return np.stack([u + how["shift"][0], v + how["shift"][1]], 1)

    def values(self, node, p):
        """What an attribute node gives to the leaves below it."""
        par = node.par
        if par["how"] == "uv":
            return par
        n = p[0].v.shape[0]
        width = self.scene.groups[par["group"]].width
        if par["how"] == "values":
            return np.tile(np.asarray(par["values"], float), (n, 1))
        if par["how"] == "expression":
            names = dict(self.scene.params) | dict(zip("xyz", p))
            results = formulas.block(par["definitions"], par["trees"], names, p[0])
            values = np.stack([formulas.kept(x).v for x in results], 1)
            return np.where(np.isnan(values), 0.0, values)
        t = textures.pattern(par, np.array([x.v for x in p]))[:, None]
        a = np.asarray(par.get("a", np.zeros(width)), float)
        b = np.asarray(par.get("b", np.ones(width)), float)
        return (1 - t) * a + t * b

    # Warps.

    def warp(self, node, p, given):
        par = node.par
        if node.kind == "warp":
            names = dict(self.scene.params) | dict(zip("xyz", p))
            moved = formulas.block(par["definitions"], par["trees"], names, p[0])
            moved = [formulas.kept(x, 2.0**40) for x in moved]
        else:
            moved = maps.WARPS[node.kind](par, p)
        if par["weighted"]:
            w = self.node(node.children[1], p, given).f
            w = D.at_most(D.at_least(w, 0.0), 1.0)
            moved = [a + w * (b - a) for a, b in zip(p, moved)]
        sample = self.node(node.children[0], moved, given)
        if par.get("box"):
            sample = self.within(par["box"], p, sample)
        return sample

    # Formulas.

    def expression(self, node, p, given):
        children = [self.node(child, p, given) for child in node.children]
        n = len(children)
        # The variables are the fields, and then x, y, z.
        variables = D.seed([s.f.v for s in children] + [x.v for x in p])
        names = dict(self.scene.params) | dict(zip("xyz", variables[n:]))
        fields = dict(zip(node.par["names"], variables))
        (f,) = formulas.block(node.par["definitions"], node.par["trees"], names, variables[0], fields)
        f = formulas.kept(f)
        parts = [s.f.d for s in children] + [x.d for x in p]
        total = D.Dual(f.v, sum(f.d[k] * parts[k] for k in range(n + 3)))
        if n == 0:
            return self.leaf(node, p, given, total)
        if n == 1:
            return Sample(total, self.passed(children[0]))
        weights = [np.maximum(0, s.f.v * f.d[k]) for k, s in enumerate(children)]
        return Sample(total, self.mean(children, weights))

    def within(self, box, p, sample):
        inside = np.ones(p[0].v.shape, bool)
        for i in range(3):
            inside &= (p[i].v >= box[0][i]) & (p[i].v <= box[1][i])
        return Sample(D.where(inside, sample.f, D.constant(0.0, sample.f)), self.passed(sample))

    def faded(self, node, child):
        name, numbers = node.par["falloff"]
        r = D.at_least(child.f, 0.0) / node.par["radius"]
        return Sample(falloffs.value(name, numbers, r * r, r), self.passed(child))

    # Operators.

    def handed(self, f, child):
        """The attributes of an only child, where both fields are positive."""
        # Rounding decides whether so little is 0.
        self.doubt |= (f > 0) & (f < 1e-6 * self.c)
        both = (f > 0) & (child.f.v > 0)
        return self.mean([child], [np.where(both, 1.0, 0.0)])

    def passed(self, child):
        """The attributes of an only child, where its field is not 0."""
        return self.mean([child], [np.where(child.f.v != 0, 1.0, 0.0)])

    def mean(self, children, weights):
        """The weights of all leaves, normalised; the default where nothing has a weight."""
        whole = sum(weights)
        safe = np.where(whole > 0, whole, 1.0)
        # What counts with the default is a leaf of its own.
        total = {len(self.leaves): np.where(whole > 0, 0.0, 1.0)}
        self.leaves.append(self.leaf_values(None, None, {}))
        for child, weight in zip(children, weights):
            share = np.where(whole > 0, weight / safe, 0.0)
            for k, w in child.weights.items():
                total[k] = total.get(k, 0.0) + w * share
        return total

    def operator(self, node, children):
        kind = node.kind
        n = len(children)
        if n == 1 and kind not in ("sum", "ricci", "complement", "clamp", "shell", "offset"):
            return children[0]
        if n > 2 and kind in FOLDED:
            folded = self.operator(node, children[:2])
            for child in children[2:]:
                folded = self.operator(node, [folded, child])
            return folded
        f = D.seed([s.f.v for s in children])
        value, weights = getattr(self, kind)(node, f)
        parts = [s.f.d for s in children]
        total = D.Dual(value.v, sum(value.d[k] * parts[k] for k in range(n)))
        if weights == "handed":
            return Sample(total, self.handed(value.v, children[0]))
        if kind in FOLDED:
            # Where a step before this one gave nobody a weight, what it made has none here.
            weights[0] = np.where(children[0].nobody, 0.0, weights[0])
        sample = Sample(total, self.mean(children, weights))
        sample.nobody = (sum(weights) == 0) if kind in FOLDED else False
        return sample

    def euler(self, f, value):
        return [np.maximum(0, x.v) * np.maximum(0, value.d[k]) for k, x in enumerate(f)]

    def sum(self, node, f):
        value = sum(f[1:], f[0])
        return value, [np.maximum(0, x.v) for x in f]

    def ricci(self, node, f):
        n = node.par["exponent"]
        if n == 1 and not getattr(n, "follows", False):
            return self.sum(node, f)
        f = [D.at_least(x, 0.0) for x in f]
        values = np.array([x.v for x in f])
        scale = values.max(0) if n > 0 else values.min(0)
        safe = np.where(scale > 0, scale, 1.0)
        unit = D.constant(safe, f[0])
        value = sum((D.power(x / unit, n) for x in f[1:]), D.power(f[0] / unit, n))
        value = D.power(value, 1 / n) * unit
        value = D.where(scale > 0, value, D.constant(0.0, f[0]))
        return value, [np.where(scale > 0, (x.v / safe) ** n, 0.0) for x in f]

    def product(self, node, f):
        value = f[0]
        for x in f[1:]:
            value = value * x * (1 / self.c)
        return value, [np.where(value.v > 0, 1.0, 0.0)] * len(f)

    def union(self, node, f):
        values = np.array([x.v for x in f])
        winner = values.argmax(0)
        return formulas.call("max", f), [np.where(winner == k, np.maximum(0, values[k]), 0.0)
                                         for k in range(len(f))]

    def intersection(self, node, f):
        values = np.array([x.v for x in f])
        winner = values.argmin(0)
        return formulas.call("min", f), [np.where(winner == k, np.maximum(0, values[k]), 0.0)
                                         for k in range(len(f))]

    def opposite(self, x):
        return D.at_least(2 * self.c - x, 0.0)

    def difference(self, node, f):
        value = f[0]
        decides = np.zeros(f[0].v.shape, int)
        for k, x in enumerate(f[1:], 1):
            y = self.opposite(x)
            decides = np.where((y.v < value.v) & (x.v > 0), k, decides)
            value = D.minimum(value, y)
        return value, [np.where((decides == k) & (value.v > 0), 1.0, 0.0) for k in range(len(f))]

    def symmetric_difference(self, node, f):
        a, b = f
        first = a.v >= b.v
        high = D.maximum(a, b)
        other = self.opposite(D.minimum(a, b))
        # Who decides: the larger one, or the smaller one by its complement, where it is there.
        cut = (other.v < high.v) & (np.minimum(a.v, b.v) > 0)
        to_first = np.where(cut, ~first, first)
        value = D.minimum(high, other)
        there = value.v > 0
        return value, [np.where(there & to_first, 1.0, 0.0), np.where(there & ~to_first, 1.0, 0.0)]

    def limited(self, k, limit):
        """A width that is k from a limit of 2k on, and 0 where the limit is."""
        lack = D.at_least(2 * k - limit, 0.0)
        return D.where(limit.v > 0, k - lack * lack / (4 * k), D.constant(0.0, limit))

    def rounded(self, a, b, k, sign):
        """The maximum and D (sign 1), or the minimum less D (sign -1); the sum of the fields limits K.

        For |a - b| < K this is (a + b) / 2 +- (K / 4 + (a - b)^2 / (4K)), which has no kink.
        """
        width = self.limited(k, a + b)
        apart = a - b
        near = (a + b) * 0.5 + sign * (width * 0.25 + apart * apart / (4.0 * width))
        far = D.maximum(a, b) if sign > 0 else D.minimum(a, b)
        return D.where(np.abs(apart.v) < width.v, near, far)

    def smooth_union(self, node, f):
        value = self.rounded(*f, D.constant(node.par["width"], f[0]), 1)
        return value, self.euler(f, value)

    def smooth_intersection(self, node, f):
        value = self.rounded(*f, D.constant(node.par["width"], f[0]), -1)
        return value, self.euler(f, value)

    def smooth_difference(self, node, f):
        a, b = f
        k = self.limited(D.constant(node.par["width"], b), b)
        y = self.opposite(b)
        value = self.rounded(a, y, k, -1)
        # For the weights the complement y is the variable, and the width stays as it is.
        u, v = D.seed([a.v, y.v])
        free = self.rounded(u, v, D.constant(k.v, u), -1)
        there = b.v > 0
        first = np.where(there, a.v * free.d[0], np.where(a.v > 0, 1.0, 0.0))
        return value, [np.maximum(0, first), np.where(there, np.maximum(0, y.v * free.d[1]), 0.0)]

    def subtracted(self, f, value):
        """What is subtracted counts by its complement, where it is there."""
        a, b = f
        y = self.opposite(b)
        weight = np.where(b.v > 0, np.maximum(0, -y.v * value.d[1]), 0.0)
        return [self.euler([a], value)[0], weight]

    def rfunction(self, node, f):
        par, c = node.par, self.c
        family, m = par["family"], par["number"]

        def r(x, y):
            if family == "alpha":
                return x + y + D.sqrt(x * x + y * y - 2 * m * x * y)
            if family == "power":
                largest = np.maximum(np.abs(x.v), np.abs(y.v))
                unit = D.constant(np.where(largest > 0, largest, 1.0), x)
                ax, ay = D.absolute(x / unit), D.absolute(y / unit)
                return x + y + D.power(D.power(ax, m) + D.power(ay, m), 1 / m) * unit
            s = D.sqrt(x * x + y * y)
            return (x + y + s) * D.whole_power(s, int(m))

        def mode(a, b):
            x, y = a / c - 1, b / c - 1
            if par["mode"] == "union":
                return r(x, y)
            if par["mode"] == "intersection":
                return -r(-x, -y)
            return -r(-x, y)

        zero = D.constant(0.0, f[0])
        value = D.at_least(c * (1 - mode(*f) / mode(zero, zero)), 0.0)
        # Rounding decides whether so little is 0.
        self.doubt |= (value.v > 0) & (value.v < 1e-5 * c)
        if par["mode"] == "difference":
            return value, self.subtracted(f, value)
        return value, self.euler(f, value)

    def complement(self, node, f):
        return 2 * self.c - f[0], "handed"

    def clamp(self, node, f):
        return D.at_most(D.at_least(f[0], node.par["low"]), node.par["high"]), "handed"

    def shell(self, node, f):
        c, t = self.c, node.par["thickness"]
        return D.at_least(c - D.absolute(f[0] - c), 0.0) * (c / (c - t / 2)), "handed"

    def offset(self, node, f):
        return f[0] * (self.c / (self.c - node.par["by"])), "handed"

    # Attributes.

    def mixed(self, group, sample):
        n = self.points.shape[1]
        default = np.tile(np.asarray(group.default, float), (n, 1))
        mean = np.zeros((n, group.width))
        best, value = np.zeros(n), default.copy()
        # Of equals the first leaf wins.
        for k in sorted(sample.weights):
            w = sample.weights[k]
            here = self.leaves[k][group.name]
            mean += w[:, None] * np.where((w > 0)[:, None], here, 0.0)
            more = w > best
            if group.dominant:
                near = (np.abs(w - best) < 1e-5) & (w != best)
                self.doubt |= near & (here != value).any(1)
            best, value = np.where(more, w, best), np.where(more[:, None], here, value)
        return value if group.dominant else mean


def evaluate(scene, points):
    """Field, gradient and attributes, and the largest values on the way."""
    run = Evaluation(scene, points)
    answer = run.run()
    answer["scale"] = run.largest_f
    answer["slope"] = run.largest_g
    answer["doubt"] = run.doubt
    answer["hard"] = run.hard
    return answer
