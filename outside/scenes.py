"""Random scenes as text, of every member of the docs, from a seed.

    python scenes.py SEED          prints one
"""

import random
import re
import sys


class Tree:
    """A node: a head, and children in braces; a leaf has none."""

    def __init__(self, head, children=(), fixed=False):
        self.head = head
        self.children = list(children)
        self.fixed = fixed      # whether the number of children may not change

    def text(self, indent=0):
        pad = "    " * indent
        if not self.children:
            return pad + self.head
        inner = "\n".join(child.text(indent + 1) for child in self.children)
        return f"{pad}{self.head} {{\n{inner}\n{pad}}}"

    def copy(self):
        return Tree(self.head, [child.copy() for child in self.children], self.fixed)


class SceneText:
    """Statements, subtrees with names, and the model."""

    def __init__(self, statements, lets, root):
        self.statements = statements
        self.lets = lets
        self.root = root

    def text(self):
        used, body = [], self.root.text()
        for name, tree in reversed(self.lets):
            if re.search(rf"\b{name}\b", body):
                used.append(f"let {name} = {tree.text()}")
                body += "\n" + used[-1]
        statements = []
        for line in reversed(self.statements):
            word = line.split()[1]
            if line.startswith("param") and not re.search(rf"\b{word}\b", body):
                continue
            statements.append(line)
            body += "\n" + line
        return "\n".join(["jbt 1", *reversed(statements), *reversed(used), self.root.text(), ""])


SKELETONS = ["point", "segment", "disc", "ring", "cylinder", "box", "triangle", "sphere", "torus", "cone",
             "round_cone", "rectangle", "arc", "helix", "half_space", "ellipsoid", "lmetric", "superquadric",
             "polyline", "polygon", "bezier", "catmull_rom"]
FALLOFFS = ["soft", "wyvill", "quartic", "metaball", "hermite", "quintic", "linear", "degree", "blinn",
            "arctan", "inverse_power", "blanc"]
ALIASES = {"soft": ["geoff"], "wyvill": ["cubic", "galin", "blender"], "quartic": ["murakami", "pov"],
           "metaball": ["nishimura", "links"], "hermite": ["hart", "smoothstep"], "quintic": ["smootherstep"],
           "linear": ["cone"], "degree": ["stolte"], "blinn": ["gaussian", "blobby"], "arctan": ["atan"],
           "inverse_power": ["inverse", "lorentz"], "blanc": ["schlick"]}
OPERATORS = ["sum", "ricci", "product", "union", "intersection", "difference", "symmetric_difference",
             "smooth_union", "smooth_intersection", "smooth_difference", "rfunction", "complement", "clamp",
             "shell", "offset", "select"]
MAPS = ["translate", "rotate", "scale", "reflect", "stretch", "shear", "affine"]
WARPS = ["twist", "taper", "bend", "mirror", "repeat", "repeat_around", "space_map", "deform", "warp"]
OTHERS = ["expression", "fields", "within", "falloff"]
ATTRIBUTES = ["values", "checker", "stripes", "gradient", "noise", "rings", "marble", "expression", "uv"]
MEMBERS = ([("skeleton", k) for k in SKELETONS] + [("falloff", k) for k in FALLOFFS]
           + [("operator", k) for k in OPERATORS] + [("map", k) for k in MAPS] + [("warp", k) for k in WARPS]
           + [("other", k) for k in OTHERS] + [("attribute", k) for k in ATTRIBUTES])


def plain(value):
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


class Maker:
    def __init__(self, seed, depth=5, screen=False):
        self.screen = screen    # whether there are colours as screens have them
        self.random = random.Random(seed)
        self.depth = depth
        self.statements = []
        self.params = {}
        self.lets = []
        self.groups = {"color": 3}
        self.iso = 0.5
        self.wanted = list(self.random.sample(MEMBERS, 6))
        self.wanted.insert(0, MEMBERS[seed % len(MEMBERS)])

    # Numbers.

    def chance(self, p):
        return self.random.random() < p

    def pick(self, items):
        return self.random.choice(items)

    def real(self, low, high, digits=2):
        return round(self.random.uniform(low, high), digits)

    def number(self, low, high, digits=2):
        """A literal, or an expression of about that value."""
        value = self.real(low, high, digits)
        way = self.random.random()
        if way < 0.12 and self.params:
            name = self.pick(list(self.params))
            factor = plain(round(value / self.params[name], 4))
            return self.pick([f"{name} * {factor}", f"({factor} * {name})"]) if value else plain(value)
        if way < 0.16:
            return f"({plain(value - 0.25)} + 0.25)"
        if way < 0.19 and value > 0:
            return f"sqrt({plain(value * value)})" if value * value > 0.01 else plain(value)
        if way < 0.21 and value > 0:
            return f"{plain(2 * value)} / 2"
        if way < 0.23 and value > 0.05:
            return f"{plain(value)} * cos(0)"
        return plain(value)

    def vector(self, low=-0.7, high=0.7, count=3):
        parts = [self.number(low, high) for _ in range(count)]
        if self.chance(0.2):
            return "(" + ", ".join(parts) + ")"
        return "(" + " ".join(p if p.startswith("-") or "-" not in p else f"({p})" for p in parts) + ")"

    def direction(self):
        if self.chance(0.3):
            return self.pick("xyz")
        while True:
            v = [self.real(-1, 1, 1) for _ in range(3)]
            if sum(x * x for x in v) > 0.1:
                return "(" + " ".join(plain(x) for x in v) + ")"

    def frame(self):
        """Two directions that are far from parallel."""
        while True:
            a = [self.real(-1, 1, 1) for _ in range(3)]
            b = [self.real(-1, 1, 1) for _ in range(3)]
            aa, bb = sum(x * x for x in a), sum(x * x for x in b)
            ab = sum(x * y for x, y in zip(a, b))
            if aa > 0.2 and bb > 0.2 and ab * ab < 0.6 * aa * bb:
                return ["(" + " ".join(plain(x) for x in v) + ")" for v in (a, b)]

    # Primitives.

    def falloff(self, literal=False):
        name = self.want("falloff") or self.pick(FALLOFFS)
        word = self.pick(ALIASES[name]) if self.chance(0.15) else name
        number = (lambda *a: plain(self.real(*a))) if literal else self.number
        inner = []
        if name == "degree":
            inner.append("exponent " + self.pick(["2", "3", "5", "8", "1.5", "2.5", number(1.2, 6)]))
        if name == "blinn":
            inner += self.some([f"hardness {number(1.5, 4)}", f"cutoff {number(1, 2)}"])
        if name == "arctan":
            inner += [f"stiffness {number(1, 12)}"]
        if name == "inverse_power":
            inner += self.some(["exponent " + self.pick(["1", "2", "3", "4", "2.5", number(1.2, 5)]),
                                f"cutoff {number(2, 5)}"])
        if name in ("blinn", "arctan", "inverse_power"):
            inner += self.some([f"edge {self.pick(['exact', 'smooth'])}"])
        if name == "blanc":
            inner += self.some([f"hardness {number(0, 4)}"])
        self.random.shuffle(inner)
        return f"{word} {{ {' '.join(inner)} }}" if inner else word

    def some(self, items):
        return [item for item in items if self.chance(0.6)]

    def want(self, family):
        for k, (what, name) in enumerate(self.wanted):
            if what == family:
                del self.wanted[k]
                return name
        return None

    def points(self, count, flat=False):
        return "(" + " ".join(self.vector(-0.8, 0.8) for _ in range(count)) + ")"

    def polygon(self):
        """Corners in a plane, around a middle; sometimes every second one, so that edges cross."""
        import math
        count = self.pick([3, 4, 5, 6, 7])
        order = [(2 * k) % 5 for k in range(5)] if count == 5 and self.chance(0.5) else range(count)
        u = [[1, 0, 0], [0, 1, 0], [0.6, 0.8, 0]]
        v = [[0, 1, 0], [0, 0.6, 0.8], [0, 0, 1]]
        k = self.random.randrange(3)
        radius = [self.real(0.3, 0.8) for _ in range(count)]
        middle = [self.real(-0.2, 0.2) for _ in range(3)]
        corners = []
        for i in order:
            s = radius[i] * math.cos(2 * math.pi * i / count)
            t = radius[i] * math.sin(2 * math.pi * i / count)
            s, t = round(s, 2), round(t, 2)
            corner = [repr(round(middle[j] + s * u[k][j] + t * v[k][j], 6)) for j in range(3)]
            corners.append("(" + " ".join(corner) + ")")
        return "(" + " ".join(corners) + ")"

    def row(self):
        """Several primitives of one kind, that differ in numbers alone; some with values."""
        kind, falloff = self.pick(SKELETONS), self.falloff()
        valued = self.pick([None, None] + [name for name in self.groups if name != "uv"])
        leaves = []
        for _ in range(self.random.randrange(4, 10)):
            leaf = self.primitive(kind, falloff)
            if valued:
                leaf = Tree(f"{valued} {self.value(valued)}", [leaf], True)
            if self.chance(0.2):
                leaf = Tree(f"translate {self.vector(-.4, .4)}", [leaf], True)
            leaves.append(leaf)
        return leaves

    def primitive(self, kind=None, falloff=None):
        kind = kind or self.want("skeleton") or self.pick(SKELETONS)
        n, v = self.number, self.vector
        parts = []
        around = self.some([f"center {v(-.4, .4)}", f"normal {self.direction()}"])
        if kind == "point":
            parts = [f"at {v()}"]
        elif kind == "segment":
            parts = [f"from {v()}", f"to {v()}"]
        elif kind == "disc":
            parts = [f"disc_radius {n(0.2, 0.7)}"] + around
        elif kind == "ring":
            parts = [f"ring_radius {n(0.2, 0.8)}"] + around
        elif kind == "cylinder":
            parts = [f"from {v()}", f"to {v()}", f"cylinder_radius {n(0.1, 0.4)}"]
        elif kind == "box":
            parts = [f"half {v(0.1, 0.6)}"] + self.some([f"center {v(-.4, .4)}"])
        elif kind == "triangle":
            parts = [f"a {v()}", f"b {v()}", f"c {v()}"]
        elif kind == "sphere":
            parts = [f"sphere_radius {n(0.1, 0.5)}"] + self.some([f"center {v(-.4, .4)}"])
        elif kind == "torus":
            parts = [f"ring_radius {n(0.3, 0.7)}", f"tube_radius {n(0.05, 0.2)}"]
            parts += self.some([f"center {v(-.4, .4)}", f"normal {self.direction()}"])
        elif kind == "cone":
            parts = [f"from {v()}", f"to {v()}", f"from_radius {n(0.1, 0.5)}"]
            parts += self.some([f"to_radius {n(0.05, 0.5)}"])
        elif kind == "round_cone":
            parts = [f"from {v()}", f"to {v()}", f"from_radius {n(0.05, 0.4)}", f"to_radius {n(0.05, 0.4)}"]
        elif kind == "rectangle":
            a, b = self.frame()
            parts = [f"normal {a}", f"along {b}", f"half_length {n(.2, .7)}", f"half_width {n(.1, .5)}"]
            parts += self.some([f"center {v(-.4, .4)}"])
        elif kind == "arc":
            a, b = self.frame()
            parts = [f"normal {a}", f"start {b}", f"degrees {n(20, 350, 0)}", f"arc_radius {n(.2, .7)}"]
            parts += self.some([f"center {v(-.4, .4)}"])
        elif kind == "helix":
            a, b = self.frame()
            pitch = self.pick([n(0.2, 0.5), "-0.35"])
            parts = [f"normal {a}", f"start {b}", f"helix_radius {n(.2, .6)}", f"pitch {pitch}"]
            parts += [f"turns {n(.5, 4, 1)}"]
            parts += self.some([f"center {v(-.3, .3)}"])
        elif kind == "half_space":
            parts = [f"at {v(-.5, .5)}", f"normal {self.direction()}"]
        elif kind == "ellipsoid":
            parts = [f"stretch {v(0.5, 1.6)}"] + self.some([f"center {v(-.4, .4)}"])
        elif kind == "lmetric":
            parts = [f"exponent {self.pick(['1', '1.5', '2', '3', '4', '7.5', n(1.2, 9)])}"]
            parts += self.some([f"center {v(-.4, .4)}", f"stretch {v(0.5, 1.6)}"])
        elif kind == "superquadric":
            parts = [f"e1 {n(0.2, 1.9)}", f"e2 {n(0.2, 1.9)}"]
            parts += self.some([f"center {v(-.4, .4)}", f"stretch {v(0.5, 1.6)}"])
        elif kind in ("polyline", "catmull_rom"):
            count = self.pick([3, 4, 5])
            parts = [f"points {self.points(count)}"] + self.some([f"closed {self.pick(['yes', 'no'])}"])
            parts += self.radii(count)
        elif kind == "polygon":
            parts = [f"points {self.polygon()}"]
        elif kind == "bezier":
            count = self.pick([4, 7])
            parts = [f"points {self.points(count)}"] + self.radii(count)
        if falloff:
            parts.append(f"radius {n(0.3, 0.9)} falloff {falloff}")
            self.random.shuffle(parts)
            return Tree(f"{kind} {{ {' '.join(parts)} }}")
        if self.chance(0.75):
            parts.append(f"radius {n(0.3, 1.1)}")
            if self.chance(0.2):
                parts.append(f"strength {self.pick([n(0.6, 1.6), '-0.4', '0.3', '2'])}")
        else:
            parts.append(f"surface_radius {n(0.1, 0.4)}")
            if self.chance(0.2):
                parts.append(f"strength {n(0.8, 1.6)}")
        if self.chance(0.6):
            parts.append(f"falloff {self.falloff()}")
        self.random.shuffle(parts)
        return Tree(f"{kind} {{ {' '.join(parts)} }}")

    def radii(self, count):
        way = self.random.random()
        if way < 0.4:
            return []
        if way < 0.6:
            return [f"radii ({self.number(0.03, 0.2)})"]
        return ["radii (" + " ".join(self.number(0.02, 0.2) for _ in range(count)) + ")"]

    # Formulas.

    def coordinate(self):
        return self.pick(["x", "y", "z", "x", "y", "z", "(x + y)", "(y - 0.5 * z)"])

    def term(self, depth=2):
        a = self.coordinate()
        k = plain(self.real(0.5, 4, 1))
        if depth > 0 and self.chance(0.3):
            a = f"({self.term(depth - 1)})"
        ways = [
            f"sin({k} * {a})", f"cos({k} * {a})", f"tan(0.3 * {a})", f"asin(0.6 * {a})", f"acos(0.5 * {a})",
            f"atan({k} * {a})", f"atan2({a}, {k} + x)", f"abs({a})", f"sign({a} - 0.13)", f"floor({k} * {a})",
            f"ceil({k} * {a})", f"round({k} * {a})", f"mod({a}, 0.{self.random.randrange(3, 9)})",
            f"exp(-{k} * {a})", f"ln({k} + square({a}))", f"square({a})", f"sqrt(abs({a}) + 0.2)",
            f"min({a}, 0.3, y)", f"max({a}, -z)", f"clamp({a}, -0.4, 0.5)", f"mix({a}, z, 0.3)",
            f"step(0.11, {a})", f"length({a}, y, 0.3)", f"pow(abs({a}) + 0.1, 1.5)", f"pow({a}, 3)", f"{a}^2",
            "(1.7 + x * x)^-2", f"{a} / (2 + y * y)", f"wyvill(length({a}, y, z))", f"soft(abs({a}))",
            f"blinn {{ hardness 3 }} (length(x, {a}))", f"-{a}", f"{a} * {self.coordinate()}",
            f"(0.5 + abs({a}))^1.7", f"mod(-{a}, 0.7)", "pi * x / 4", f"(1 + abs({a}))^(0.5 + 0.3 * y)",
            f"sqrt({a})", f"{a}^1.5", f"ln({a})", f"pow({a}, 0.5 + y)", f"1 / (0.3 + {a})", f"{a}^(4 - 1)",
        ]
        if self.params:
            name = self.pick(list(self.params))
            ways += [f"{name} * {a}", f"sin({name} + {a})", f"pow(abs({a}) + 0.2, {name})"]
        return self.pick(ways)

    def formula(self):
        parts = [self.term()]
        for _ in range(self.random.randrange(1, 3)):
            parts.append(f"{plain(self.real(0.1, 0.5))} * {self.term()}")
        text = parts[0]
        for part in parts[1:]:
            text += self.pick([" + ", " - "]) + part
        return text

    def box(self, small=0.5, large=1.3):
        low = "(" + " ".join("-" + plain(self.real(small, large)) for _ in range(3)) + ")"
        high = "(" + " ".join(plain(self.real(small, large)) for _ in range(3)) + ")"
        return f"within {low} to {high}"

    def expression(self):
        within = self.box() + " " if self.chance(0.5) else ""
        body = f"0.6 - 0.5 * length(x, y, z) + 0.2 * ({self.formula()})"
        if self.chance(0.3):
            body = f"d = {self.formula()}, e = 0.3 * d, 0.5 - 0.4 * e + 0.1 * d * x"
        return Tree(f"expression {within}{{ {body} }}")

    def fields(self):
        """A formula of fields of subtrees with names."""
        while len(self.lets) < 2:
            self.let(1)
        names = [name for name, _ in self.lets]
        a, b, c = (f"field({self.pick(names)})" for _ in range(3))
        p = self.pick(list(self.params)) if self.params else "0.7"
        ways = [
            f"0.7 * {a} * {b} + 0.3 * {c}^2", f"min({a}, 1 - {b})", f"sqrt(abs({a} * {b}))",
            f"{a} * (1 + 0.2 * sin(5 * x))", f"max({a}, 0.8 * {b}) - 0.2 * {c}", f"1.2 * {a}",
            f"{a}^2 + {b}^2",
            f"mix({a}, {b}, clamp(x, 0, 1))", f"{p} * {a} + 0.4 * {b}", f"{a} + 0.1 * sin(6 * z) * {b}",
            f"r = 1 - {a}, (1 - r)^3 * (1 + 3 * r)", f"{a} * {b} / ({a} + {b} + 0.1)", f"exp({a}) - 1",
            f"length({a}, {b})", f"{a} - 0.5 * {b}", f"0.5 * {a} / {b}", f"{a} - {a} * {b} / ({a} + {b})",
        ]
        within = self.box() + " " if self.chance(0.2) else ""
        return Tree(f"expression {within}{{ {self.pick(ways)} }}")

    # Nodes.

    def let(self, depth):
        name = f"part{len(self.lets)}"
        tree = self.node(depth)
        self.lets.append((name, tree))
        # A subtree may ask for more of them: names go up in the order of definitions.
        used = {n for n, _ in self.lets[:-1]}
        if name in used:
            self.lets[-1] = (f"part{len(self.lets) + 20}", tree)

    def node(self, depth):
        if depth <= 0:
            return self.leaf()
        for family, make in (("operator", self.operator), ("map", self.map), ("warp", self.warp),
                             ("other", self.other), ("attribute", self.attribute)):
            if any(what == family for what, _ in self.wanted) and self.chance(0.6):
                return make(depth)
        way = self.random.random()
        if way < 0.42:
            return self.operator(depth)
        if way < 0.54:
            return self.map(depth)
        if way < 0.64:
            return self.warp(depth)
        if way < 0.70:
            return self.other(depth)
        if way < 0.84:
            return self.attribute(depth)
        return self.leaf()

    def leaf(self):
        way = self.random.random()
        if self.lets and way < 0.15:
            return Tree("use " + self.pick([name for name, _ in self.lets]))
        if way < 0.22:
            return self.expression()
        leaf = self.primitive()
        if way < 0.75:
            leaf = self.valued(leaf)
        return leaf

    def valued(self, child):
        name = self.pick(list(self.groups))
        if name == "uv":
            return Tree(self.uv(), [child], True)
        return Tree(f"{name} {self.value(name)}", [child], True)

    def value(self, name):
        width = self.groups[name]
        if self.screen and width == 3 and self.chance(0.3):
            if self.chance(0.5):
                return "srgb" + self.vector(0.05, 1)
            return self.pick(['"#ff8800"', '"#f80"', '"#0a1B2c"', f'"#{self.random.randrange(16**6):06x}"'])
        if name == "mat":
            return plain(self.random.randrange(1, 9))
        if width == 1:
            return self.number(0.05, 1)
        return self.vector(0.05, 1, width)

    def operator(self, depth):
        kind = self.want("operator") or self.pick(OPERATORS)
        n = self.number
        if kind in ("complement", "clamp", "shell", "offset"):
            child = [self.node(depth - 1)]
            c = self.iso
            if kind == "clamp":
                return Tree(f"clamp low {self.pick(['0', '-0.2', '0.1'])} high {n(0.7, 1)}", child, True)
            if kind == "shell":
                return Tree(f"shell {self.pick(['thickness ', ''])}{n(0.1 * c, 0.9 * c)}", child, True)
            if kind == "offset":
                return Tree(f"offset {self.pick(['by ', ''])}{n(-0.4 * c, 0.5 * c)}", child, True)
            if self.chance(0.5):
                return Tree("intersection", [self.primitive(), Tree("complement", child, True)])
            return Tree("complement", child, True)
        count = self.pick([2, 2, 2, 3, 3, 4, 1 if self.chance(0.2) else 2])
        children = [self.node(depth - 1)]
        for _ in range(count - 1):
            children.append(self.node(self.pick([0, depth - 2, depth - 1])))
        if kind != "select" and self.chance(0.12):
            children = self.row() if self.chance(0.5) else children[:1] + self.row()
        head = kind
        if kind == "ricci":
            e = self.pick(["1", "2", "3", "8", "1.5", "-2", "-3", "-1", "20", n(1.2, 6), n(-6, -1.2)])
            head = self.pick(["ricci ", "blend ricci "]) + e
        elif kind.startswith("smooth"):
            head = f"{kind} {self.pick(['width ', ''])}{n(0.1, 0.4)}"
        elif kind == "rfunction":
            head = "rfunction " + self.pick(["union", "intersection", "difference"])
            # R_0^m grows with every child: more than three may be beyond f32.
            if len(children) > 3:
                children = children[:4]
                head += self.pick(["", f" alpha {n(-0.6, 0.9)}", " alpha 1", f" power {n(1.3, 5)}"])
                return Tree(head, children)
            head += self.pick(["", f" alpha {n(-0.6, 0.9)}", " alpha 1", f" power {n(1.3, 5)}", " order 1",
                               " order 2"])
        elif kind == "select":
            head = f"select {self.random.randrange(count)}"
            if self.chance(0.3):
                head += "." + self.pick(["2", "3"])
        return Tree(head, children, kind == "select")

    def map(self, depth):
        kind = self.want("map") or self.pick(MAPS)
        n = self.number
        if kind == "translate":
            head = f"translate {self.vector(-.4, .4)}"
        elif kind == "rotate":
            head = f"rotate axis {self.direction()} "
            head += self.pick([f"degrees {n(-180, 180, 0)}", f"radians {n(-3, 3)}"])
        elif kind == "scale":
            head = "scale " + self.pick([n(0.6, 1.5), self.vector(0.6, 1.5), "(-1 1 1.2)", "-0.9"])
        elif kind == "reflect":
            head = f"reflect axis {self.direction()}"
        elif kind == "stretch":
            head = f"stretch axis {self.direction()} by {n(0.6, 1.7)}"
        elif kind == "shear":
            head = f"shear axis {self.pick('xyz')} by {self.vector(-.4, .4)}"
        else:
            rows = []
            for i in range(3):
                for j in range(3):
                    rows.append(plain((1 if i == j else 0) + self.real(-0.3, 0.3)))
                rows.append(plain(self.real(-0.3, 0.3)))
            head = "affine (" + " ".join(rows) + ")"
        return Tree(head, [self.node(depth - 1)], True)

    def warp(self, depth):
        kind = self.want("warp") or self.pick(WARPS)
        n = self.number
        axis = self.pick(["axis x ", "axis y ", "axis z ", ""])
        head = kind
        if kind == "twist":
            head = f"twist {axis}rate {n(-2.5, 2.5)}"
        elif kind == "taper":
            head = f"taper {axis}from {n(-.8, -.2)} to {n(.2, .8)} end {n(.3, 1.4)}"
            head += self.pick(["", f" start {n(.5, 1.4)}"])
        elif kind == "bend":
            head = f"bend {axis}rate {n(-1.4, 1.4)} from {n(-.8, -.2)} to {n(.2, .8)}"
            head += self.pick(["", f" center {n(-.3, .3)}"])
        elif kind == "mirror":
            head = f"mirror {axis}".strip()
        elif kind == "repeat":
            head = f"repeat {axis}spacing {n(.4, 1)}" + self.pick(["", " count 2", " count 3", " count 0"])
        elif kind == "repeat_around":
            head = f"repeat_around {axis}count {self.random.randrange(1, 8)}"
        elif kind == "space_map":
            head = f"space_map from {self.vector(-.2, .2)} to {self.vector(-.2, .2)} radius {n(1.2, 2)}"
        elif kind == "deform":
            parts = self.some([f"by {self.vector(-.3, .3)}", f"axis {self.direction()}",
                               f"degrees {n(-90, 90, 0)}", f"size {self.vector(.7, 1.5)}",
                               f"center {self.vector(-.3, .3)}"])
            self.random.shuffle(parts)
            head = " ".join(["deform"] + parts)
        else:
            k = plain(self.real(1, 5, 1))
            head = "warp " + self.pick([
                f"(x + 0.1 * sin({k} * y), y, z)", f"(x, y + 0.1 * cos({k} * z), z * 1.1)",
                "(s = 1 + 0.2 * z, x / s, y * s, z)", "(x, y - 0.2 * x^2, z + 0.1 * x * y)"])
            if self.chance(0.5):
                head += " " + self.box(0.7, 1.4)
        child = self.node(depth - 1)
        if self.chance(0.25) and kind not in ("repeat", "repeat_around"):
            return Tree(head + " weighted", [child, self.primitive()], True)
        return Tree(head, [child], True)

    def other(self, depth):
        kind = self.want("other") or self.pick(OTHERS)
        if kind == "expression":
            return self.expression()
        if kind == "fields":
            return self.fields()
        if kind == "within":
            return Tree(self.box(), [self.node(depth - 1)], True)
        child = self.pick([self.expression, lambda: self.node(depth - 2),
                           lambda: Tree("expression { max(length(x, y) - 0.5, abs(z) - 0.2) }")])()
        return Tree(f"falloff {self.falloff(True)} radius {self.number(.3, .9)}", [child], True)

    def uv(self):
        parts = self.some([f"scale {self.pick(['2', '(4 1)', '(2 -3)'])}",
                           f"rotate {self.number(-90, 90, 0)}",
                           f"shift {self.vector(-1, 1, 2)}"])
        return " ".join(["uv"] + parts)

    def attribute(self, depth):
        kind = self.want("attribute") or self.pick(ATTRIBUTES)
        child = self.node(depth - 1)
        if kind == "uv":
            if "uv" not in self.groups:
                kind = "values"
            else:
                return Tree(self.uv(), [child], True)
        name = self.pick([k for k in self.groups if k not in ("uv", "mat")])
        width = self.groups[name]
        prefix = self.pick(["", "", "with "]) + name
        if kind == "values":
            return Tree(f"{prefix} {self.value(name)}", [child], True)
        if kind == "expression":
            ways = ["0.5 + 0.5 * sin(3 * x)", "length(x, y)", "0.3 * z + 0.5", "r * r", "1 - 0.2 * r"]
            parts = [self.pick(ways) for _ in range(width)]
            body = parts[0] if width == 1 else "(" + ", ".join(parts) + ")"
            return Tree(f"{prefix} expression {{ r = length(x, y, z), {body} }}", [child], True)
        n = self.number
        value = (lambda: n(0, 1)) if width == 1 else (lambda: self.vector(0, 1, width))
        parts = [f"a {value()}", f"b {value()}"]
        if kind == "checker":
            parts += self.some([f"size {n(.2, .7)}"])
        if kind == "stripes":
            parts += self.some([f"along {self.direction()}", f"width {n(.1, .5)}"])
        if kind == "gradient":
            parts += [f"from {self.vector()}", f"to {self.vector()}"]
        if kind == "noise":
            parts += self.some([f"size {n(.2, .7)}", f"octaves {n(1, 4, 1)}",
                                f"seed {self.random.randrange(-9, 99)}"])
        if kind in ("rings", "marble"):
            parts += self.some([f"along {self.direction()}", f"width {n(.1, .5)}",
                                f"turbulence {n(0, 2)}", f"size {n(.3, .9)}",
                                f"seed {self.random.randrange(99)}"])
        return Tree(f"{prefix} {kind} {{ {' '.join(parts)} }}", [child], True)

    def scene(self):
        if self.chance(0.3):
            self.iso = self.pick([0.4, 0.6, 0.45])
            self.statements.append(f"iso {self.iso}")
        for k in range(self.random.randrange(0, 4)):
            value = self.real(0.3, 1.5)
            self.params[f"size{k}"] = value
            self.statements.append(f"param size{k} = {plain(value)}")
            if k and self.chance(0.3):
                self.params[f"size{k}"] = 2 * self.params["size0"]
                self.statements[-1] = f"param size{k} = 2 * size0"
        if self.chance(0.3):
            mixing = self.pick(["", " blend", " dominant"])
            self.statements.append("attribute color 3 default (0.8 0.7 0.6)" + mixing)
        if self.chance(0.6):
            self.statements.append("attribute rough 1 default 0.5")
            self.groups["rough"] = 1
        if self.chance(0.5):
            self.statements.append("attribute mat 1 dominant")
            self.groups["mat"] = 1
        if self.chance(0.25):
            self.statements.append("attribute wide 5 default (0 0.1 0.2 0.3 0.4)")
            self.groups["wide"] = 5
        if self.chance(0.3) or ("attribute", "uv") in self.wanted:
            self.statements.append("attribute uv 2")
            self.groups["uv"] = 2
        for _ in range(self.random.randrange(0, 3)):
            self.let(self.random.randrange(0, 3))
        root = self.node(self.depth)
        for _ in range(4):
            if root.children:
                break
            root = self.node(self.depth)
        return SceneText(self.statements, self.lets, root)


def scene(seed, depth=None, screen=False):
    if depth is None:
        depth = 3 + seed % 3
    return Maker(seed, depth, screen).scene()


ONE = ["neg", "abs", "sqrt", "square", "floor", "ceil", "round", "sin", "cos", "tan", "asin", "acos", "atan",
       "exp", "ln", "log", "not", "recip"]
TWO = ["add", "sub", "mul", "div", "pow", "min", "max", "mod", "atan2", "compare", "and", "or",
       "min", "max", "min", "max", "add", "sub"]


def program(seed):
    """A program of instructions."""
    chance = random.Random(seed)
    lines = ["_0 var-x", "_1 var-y", "_2 var-z"]
    for _ in range(chance.randrange(6, 30)):
        names = [f"_{k}" for k in range(len(lines))]
        # Mostly the last lines, so that much of it counts.
        a, b = (chance.choice(names[-6:] if chance.random() < 0.7 else names) for _ in range(2))
        # An operation of constants alone may be an error.
        plain_ones = {line.split()[0] for line in lines if " const " in line}
        if a in plain_ones and b in plain_ones:
            a = b = f"_{chance.randrange(3)}"
        if a in plain_ones:
            a, b = b, a
        way = chance.random()
        if way < 0.2:
            what = f"const {plain(round(chance.uniform(-2, 3), chance.choice([0, 1, 2])))}"
        elif way < 0.5:
            what = f"{chance.choice(ONE)} {a}"
        else:
            what = f"{chance.choice(TWO)} {a} {b}"
        lines.append(f"_{len(lines)} {what}")
    k = len(lines)
    lines += [f"_{k} atan _{k - 1}", f"_{k + 1} max _{k} _{k - 2}", f"_{k + 2} min _{k + 1} _{k}"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(scene(int(sys.argv[1]) if len(sys.argv) > 1 else 0).text())
