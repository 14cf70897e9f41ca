"""Reads the text format: words, numbers, statements, nodes."""

import math
import re
from dataclasses import dataclass, field

from . import falloffs
from .formulas import FUNCTIONS, SceneError, fields_of, plain


class Number(float):
    """A number that knows whether it follows a parameter."""

    follows = False


def number(value, follows=False):
    result = Number(value)
    result.follows = follows
    return result


@dataclass(eq=False)
class Node:
    kind: str
    par: dict = field(default_factory=dict)
    children: list = field(default_factory=list)


@dataclass
class Group:
    name: str
    width: int
    default: list
    dominant: bool = False


@dataclass
class Scene:
    iso: float
    groups: dict
    root: Node
    params: dict


REQUIRED = object()

# For each skeleton its parameters: the kind of each, and its default.
V, DIR, N, YES, POINTS, LIST = "vector", "direction", "number", "yes", "points", "list"
ORIGIN = [0.0, 0.0, 0.0]
SKELETONS = {
    "point": {"at": (V, ORIGIN)},
    "segment": {"from": (V, REQUIRED), "to": (V, REQUIRED)},
    "disc": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "disc_radius": (N, REQUIRED)},
    "ring": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "ring_radius": (N, REQUIRED)},
    "cylinder": {"from": (V, REQUIRED), "to": (V, REQUIRED), "cylinder_radius": (N, REQUIRED)},
    "box": {"center": (V, ORIGIN), "half": (V, REQUIRED)},
    "triangle": {"a": (V, REQUIRED), "b": (V, REQUIRED), "c": (V, REQUIRED)},
    "sphere": {"center": (V, ORIGIN), "sphere_radius": (N, REQUIRED)},
    "torus": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "ring_radius": (N, REQUIRED),
              "tube_radius": (N, REQUIRED)},
    "cone": {"from": (V, REQUIRED), "to": (V, REQUIRED), "from_radius": (N, REQUIRED), "to_radius": (N, 0.0)},
    "round_cone": {"from": (V, REQUIRED), "to": (V, REQUIRED), "from_radius": (N, REQUIRED),
                   "to_radius": (N, REQUIRED)},
    "rectangle": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "along": (DIR, [1, 0, 0]),
                  "half_length": (N, REQUIRED), "half_width": (N, REQUIRED)},
    "arc": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "start": (DIR, [1, 0, 0]),
            "degrees": (N, REQUIRED), "arc_radius": (N, REQUIRED)},
    "helix": {"center": (V, ORIGIN), "normal": (DIR, [0, 0, 1]), "start": (DIR, [1, 0, 0]),
              "helix_radius": (N, REQUIRED), "pitch": (N, REQUIRED), "turns": (N, REQUIRED)},
    "half_space": {"at": (V, ORIGIN), "normal": (DIR, [0, 0, 1])},
    "ellipsoid": {"center": (V, ORIGIN), "stretch": (V, REQUIRED)},
    "lmetric": {"center": (V, ORIGIN), "exponent": (N, REQUIRED), "stretch": (V, [1, 1, 1])},
    "superquadric": {"center": (V, ORIGIN), "e1": (N, REQUIRED), "e2": (N, REQUIRED),
                     "stretch": (V, [1, 1, 1])},
    "polyline": {"points": (POINTS, REQUIRED), "radii": (LIST, []), "closed": (YES, False)},
    "polygon": {"points": (POINTS, REQUIRED)},
    "bezier": {"points": (POINTS, REQUIRED), "radii": (LIST, [])},
    "catmull_rom": {"points": (POINTS, REQUIRED), "radii": (LIST, []), "closed": (YES, False)},
}
LEAF = {"radius": (N, None), "surface_radius": (N, None), "falloff": ("falloff", ("soft", {})),
        "strength": (N, 1.0)}

# Warps by formulas of the page of maps.
WARPS = {
    "twist": {"axis": ("axis", "z"), "rate": (N, REQUIRED)},
    "taper": {"axis": ("axis", "z"), "from": (N, REQUIRED), "to": (N, REQUIRED), "start": (N, 1.0),
              "end": (N, REQUIRED)},
    "bend": {"axis": ("axis", "z"), "rate": (N, REQUIRED), "from": (N, REQUIRED), "to": (N, REQUIRED),
             "center": (N, 0.0)},
    "mirror": {"axis": ("axis", "z")},
    "repeat": {"axis": ("axis", "z"), "spacing": (N, REQUIRED), "count": (N, 0.0)},
    "repeat_around": {"axis": ("axis", "z"), "count": (N, REQUIRED)},
    "space_map": {"from": (V, REQUIRED), "to": (V, REQUIRED), "radius": (N, REQUIRED)},
    "deform": {"by": (V, ORIGIN), "axis": (DIR, [0, 0, 1]), "degrees": (N, 0.0), "size": (V, [1, 1, 1]),
               "center": (V, ORIGIN)},
}

PATTERNS = {
    "checker": {"size": (N, 1.0)},
    "stripes": {"along": (DIR, [1, 0, 0]), "width": (N, 1.0)},
    "gradient": {"from": (V, REQUIRED), "to": (V, REQUIRED)},
    "noise": {"size": (N, 1.0), "octaves": (N, 1.0), "seed": (N, 0.0)},
    "rings": {"along": (DIR, [0, 0, 1]), "width": (N, 1.0), "turbulence": (N, 0.5), "size": (N, 1.0),
              "seed": (N, 0.0)},
    "marble": {"along": (DIR, [1, 0, 0]), "width": (N, 1.0), "turbulence": (N, 1.5), "size": (N, 1.0),
               "seed": (N, 0.0)},
}

SEVERAL = {"sum", "product", "union", "intersection", "difference", "symmetric_difference"}
SMOOTH = {"smooth_union", "smooth_intersection", "smooth_difference"}

TOKEN = re.compile(r'(?P<string>"#[0-9a-fA-F]+")|'
                   r"(?P<blank>\s+|#[^\n]*|//[^\n]*)"
                   r"|(?P<num>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)"
                   r"|(?P<word>[A-Za-z]\w*)|(?P<sign>[(){}+\-*/^=,])")


def linear(value):
    """A number of a screen as linear light, by IEC 61966-2-1."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


@dataclass
class Token:
    kind: str
    text: str
    before: bool        # whether a blank is before it
    after: bool         # and behind
    at: int


def tokens(text):
    found, at, blank = [], 0, True
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise SceneError(f"line {text.count(chr(10), 0, at) + 1}: {text[at:at + 10]!r}")
        if match.lastgroup == "blank":
            blank = True
            if found:
                found[-1].after = True
        else:
            found.append(Token(match.lastgroup, match.group(), blank, False, at))
            blank = False
        at = match.end()
    found.append(Token("end", "", True, True, len(text)))
    return found


class Parser:
    def __init__(self, text, settings=None):
        self.text = text
        self.tokens = tokens(text)
        self.at = 0
        self.settings = dict(settings or {})
        self.params = {}
        self.lets = {}
        self.groups = {"color": Group("color", 3, [1.0, 1.0, 1.0])}

    # Words and signs.

    @property
    def next(self):
        return self.tokens[self.at]

    def fail(self, message):
        line = self.text.count("\n", 0, self.next.at) + 1
        raise SceneError(f"line {line}, at {self.next.text!r}: {message}")

    def take(self, text):
        if self.next.text == text and self.next.kind != "end":
            self.at += 1
            return True
        return False

    def expect(self, text):
        if not self.take(text):
            self.fail(f"expected {text!r}")

    def word(self):
        if self.next.kind != "word":
            self.fail("expected a word")
        self.at += 1
        return self.tokens[self.at - 1].text

    # Formulas, as trees.

    def formula(self, direct=False):
        left = self.formula_product()
        while self.next.text in ("+", "-"):
            if direct and self.next.before and not self.next.after:
                break
            op = self.word_or_sign()
            left = (op, left, self.formula_product())
        return left

    def word_or_sign(self):
        self.at += 1
        return self.tokens[self.at - 1].text

    def formula_product(self):
        left = self.formula_minus()
        while self.next.text in ("*", "/"):
            op = self.word_or_sign()
            left = (op, left, self.formula_minus())
        return left

    def formula_minus(self):
        if self.take("-"):
            return ("neg", self.formula_minus())
        if self.take("+"):
            return self.formula_minus()
        base = self.primary()
        if self.take("^"):
            return ("^", base, self.formula_minus())
        return base

    def primary(self):
        token = self.next
        if token.kind == "num":
            self.at += 1
            return ("num", float(token.text))
        if self.take("("):
            inner = self.formula()
            self.expect(")")
            return inner
        if token.kind == "word":
            name = self.word()
            if name == "field" and self.take("("):
                inner = self.word()
                self.expect(")")
                return ("field", inner)
            behind = self.next.text
            if name in falloffs.WORDS and name not in FUNCTIONS and behind in ("(", "{"):
                return self.falloff_call(name)
            if name in falloffs.WORDS and behind == "{":
                return self.falloff_call(name)
            if name in FUNCTIONS and self.take("("):
                return ("call", name, self.arguments())
            return ("name", name)
        self.fail("expected a number")

    def falloff_call(self, name):
        numbers = self.falloff_numbers(name)
        self.expect("(")
        (inner,) = self.arguments()
        return ("falloff", falloffs.WORDS[name], numbers, inner)

    def arguments(self):
        args = [self.formula()]
        while not self.take(")"):
            self.expect(",")
            args.append(self.formula())
        return args

    # Numbers.

    def value_of(self, tree):
        kind = tree[0]
        if kind == "num":
            return number(tree[1])
        if kind == "name":
            if tree[1] in self.params:
                return number(self.params[tree[1]], True)
            if tree[1] == "pi":
                return number(math.pi)
            self.fail(f"no parameter {tree[1]}")
        if kind == "neg":
            inner = self.value_of(tree[1])
            return number(-inner, inner.follows)
        if kind == "call":
            args = [self.value_of(a) for a in tree[2]]
            name = tree[1]
        elif kind in ("+", "-", "*", "/", "^"):
            args = [self.value_of(tree[1]), self.value_of(tree[2])]
            name = kind
        else:
            self.fail("not in a number")
        return number(plain(name, args), any(a.follows for a in args))

    def number(self, direct=False):
        value = self.value_of(self.formula(direct))
        if not math.isfinite(value):
            self.fail("no finite number")
        return value

    def list(self):
        """Numbers in parentheses."""
        self.expect("(")
        values = []
        while not self.take(")"):
            values.append(self.number(direct=True))
            self.take(",")
        return values

    def vector(self, count=3):
        values = self.list()
        if len(values) != count:
            self.fail(f"expected {count} numbers")
        return values

    def direction(self):
        if self.next.text in ("x", "y", "z"):
            word = self.word()
            return [float(word == axis) for axis in "xyz"]
        return self.vector()

    def points(self):
        self.expect("(")
        values = []
        while not self.take(")"):
            values.append(self.vector())
            self.take(",")
        return values

    def number_or_vector(self):
        """One number, or a vector: a parenthesis with one number in it is a number."""
        if self.next.text == "(":
            start = self.at
            values = self.list()
            if len(values) > 1:
                return values
            self.at = start
        return self.number()

    def parameter(self, kind):
        if kind == V:
            return self.vector()
        if kind == DIR:
            return self.direction()
        if kind == N:
            return self.number()
        if kind == POINTS:
            return self.points()
        if kind == LIST:
            return self.list()
        if kind == "axis":
            word = self.word()
            if word not in ("x", "y", "z"):
                self.fail("expected an axis")
            return word
        if kind == YES:
            word = self.word()
            if word not in ("yes", "no"):
                self.fail("expected yes or no")
            return word == "yes"
        if kind == "falloff":
            return self.falloff()
        raise ValueError(kind)

    def parameters(self, table, closing=None):
        """Parameters by name, in any order, up to a sign or to what is none."""
        values = {}
        while self.next.text != closing and self.next.text in table:
            name = self.word()
            if name in values:
                self.fail(f"{name} twice")
            values[name] = self.parameter(table[name][0])
        for name, (_, default) in table.items():
            if name not in values:
                if default is REQUIRED:
                    self.fail(f"{name} is missing")
                values[name] = default
        return values

    def falloff_numbers(self, name):
        name = falloffs.WORDS[name]
        numbers = dict(falloffs.DEFAULTS.get(name, {}))
        if self.take("{"):
            while not self.take("}"):
                key = self.word()
                if key not in numbers:
                    self.fail(f"{name} has no {key}")
                numbers[key] = self.word() if key == "edge" else self.number()
        if any(v is None for v in numbers.values()):
            self.fail("a number is missing")
        return numbers

    def falloff(self):
        word = self.word()
        if word not in falloffs.WORDS:
            self.fail("no falloff")
        return falloffs.WORDS[word], self.falloff_numbers(word)

    # Statements.

    def scene(self):
        self.expect("jbt")
        self.expect("1")
        iso, root = 0.5, None
        while self.next.kind != "end":
            if self.take("iso"):
                iso = self.number()
            elif self.take("param"):
                name = self.word()
                self.expect("=")
                value = self.number()
                self.params[name] = float(self.settings.get(name, value))
            elif self.take("attribute"):
                self.group()
            elif self.take("let"):
                name = self.word()
                self.expect("=")
                self.lets[name] = self.node()
            else:
                if root is not None:
                    self.fail("a second node")
                root = self.node()
        if root is None:
            self.fail("no node")
        return Scene(float(iso), self.groups, root, dict(self.params))

    def group(self):
        name = self.word()
        width = int(self.number())
        group = Group(name, width, [0.0] * width)
        if self.take("default"):
            group.default = [float(v) for v in self.values(width)]
        if self.take("dominant"):
            group.dominant = True
        else:
            self.take("blend")
        self.groups[name] = group

    def values(self, width):
        if width in (3, 4) and (self.next.kind == "string" or self.next.text == "srgb"):
            return self.screen_colour(width)
        if width == 1:
            value = self.number_or_vector()
            return [value] if isinstance(value, float) else value
        return self.vector(width)

    def screen_colour(self, width):
        """A colour as screens have it, in linear numbers; a fourth one stays as it is."""
        if self.take("srgb"):
            values = self.vector(width)
        else:
            digits = self.word_or_sign()[2:-1]
            size = {width: 1, 2 * width: 2}.get(len(digits))
            if size is None:
                self.fail("another number of digits is expected")
            parts = [digits[k:k + size] for k in range(0, len(digits), size)]
            values = [int(part * (3 - size), 16) / 255 for part in parts]
        return [linear(v) for v in values[:3]] + [float(v) for v in values[3:]]

    # Nodes.

    def child(self):
        self.expect("{")
        node = self.node()
        self.expect("}")
        return [node]

    def several(self):
        self.expect("{")
        nodes = []
        while not self.take("}"):
            nodes.append(self.node())
        return nodes

    def box(self):
        low = self.vector()
        self.expect("to")
        return low, self.vector()

    def definitions(self):
        """Names with formulas, each with a comma behind it."""
        found = []
        while self.next.kind == "word" and self.tokens[self.at + 1].text == "=":
            name = self.word()
            self.expect("=")
            found.append((name, self.formula()))
            self.expect(",")
        return found

    def formulas(self, count):
        """Formulas in parentheses, and the definitions before them."""
        self.expect("(")
        definitions = self.definitions()
        trees = [self.formula(direct=True)]
        while not self.take(")"):
            self.take(",")
            trees.append(self.formula(direct=True))
        if len(trees) != count:
            self.fail(f"expected {count} formulas")
        return definitions, trees

    def block(self, count):
        """Definitions and formulas in braces."""
        self.expect("{")
        definitions = self.definitions()
        if count == 1:
            trees = [self.formula()]
        else:
            more, trees = self.formulas(count)
            definitions += more
        self.expect("}")
        return definitions, trees

    def maybe_named(self, name):
        self.take(name)
        return self.number()

    def node(self):
        word = self.word()
        if word == "use":
            name = self.word()
            if name not in self.lets:
                self.fail(f"no subtree {name}")
            return self.lets[name]
        if word == "with":
            return self.attribute(self.word())
        if word in SKELETONS:
            self.expect("{")
            par = self.parameters(SKELETONS[word] | LEAF)
            self.expect("}")
            return Node(word, par)
        if word in SEVERAL:
            return Node(word, {}, self.several())
        if word in SMOOTH:
            return Node(word, {"width": self.maybe_named("width")}, self.several())
        if word == "blend":
            if self.take("ricci"):
                word = "ricci"
            else:
                self.fail("expected ricci")
        if word == "ricci":
            return Node(word, {"exponent": self.number()}, self.several())
        if word == "rfunction":
            par = {"mode": self.word(), "family": "alpha", "number": 0.0}
            if self.next.text in ("alpha", "power", "order"):
                par["family"] = self.word()
                par["number"] = self.number()
            return Node(word, par, self.several())
        if word == "complement":
            return Node(word, {}, self.child())
        if word == "clamp":
            low = self.maybe_named("low")
            high = self.maybe_named("high")
            return Node(word, {"low": low, "high": high}, self.child())
        if word == "shell":
            return Node(word, {"thickness": self.maybe_named("thickness")}, self.child())
        if word == "offset":
            return Node(word, {"by": self.maybe_named("by")}, self.child())
        if word == "select":
            return Node(word, {"number": self.number()}, self.several())
        if word in ("translate", "rotate", "scale", "reflect", "stretch", "shear", "affine"):
            return self.map(word)
        if word in WARPS:
            return self.weighted(word, self.parameters(WARPS[word]))
        if word == "warp":
            return self.warp()
        if word == "expression":
            box = self.box() if self.take("within") else None
            definitions, trees = self.block(1)
            names = fields_of(definitions, trees)
            for name in names:
                if name not in self.lets:
                    self.fail(f"no subtree {name}")
            node = Node(word, {"definitions": definitions, "trees": trees, "names": names},
                        [self.lets[name] for name in names])
            return Node("within", {"box": box}, [node]) if box else node
        if word == "within":
            return Node(word, {"box": self.box()}, self.child())
        if word == "falloff":
            name, numbers = self.falloff()
            self.expect("radius")
            radius = self.number()
            return Node(word, {"falloff": (name, numbers), "radius": radius}, self.child())
        if word in self.groups:
            return self.attribute(word)
        self.at -= 1
        self.fail("no node")

    def map(self, word):
        if word == "translate":
            par = {"by": self.vector()}
        elif word == "rotate":
            par = {"axis": [0.0, 0.0, 1.0], "angle": 0.0}
            while self.next.text in ("axis", "degrees", "radians"):
                key = self.word()
                if key == "axis":
                    par["axis"] = self.direction()
                elif key == "degrees":
                    par["angle"] = math.radians(self.number())
                else:
                    par["angle"] = float(self.number())
        elif word == "scale":
            by = self.number_or_vector()
            par = {"by": [by] * 3 if isinstance(by, float) else by}
        elif word == "affine":
            par = {"rows": self.vector(12)}
        else:
            table = {"axis": (DIR, REQUIRED)}
            if word != "reflect":
                table["by"] = (N if word == "stretch" else V, REQUIRED)
            par = self.parameters(table)
        return Node(word, par, self.child())

    def weighted(self, word, par):
        if self.take("weighted"):
            children = self.several()
            if len(children) != 2:
                self.fail("expected two children")
            par["weighted"] = True
            return Node(word, par, children)
        par["weighted"] = False
        return Node(word, par, self.child())

    def warp(self):
        # Definitions stand before the three formulas, inside of the parentheses.
        definitions, trees = self.formulas(3)
        par = {"definitions": definitions, "trees": trees, "box": None}
        if self.take("within"):
            par["box"] = self.box()
        return self.weighted("warp", par)

    def attribute(self, name):
        if name not in self.groups:
            self.fail(f"no group {name}")
        group = self.groups[name]
        par = {"group": name}
        if name == "uv" and self.next.text in ("{", "scale", "rotate", "shift"):
            par |= {"how": "uv", "scale": [1.0, 1.0], "rotate": 0.0, "shift": [0.0, 0.0]}
            while self.next.text in ("scale", "rotate", "shift"):
                key = self.word()
                if key == "scale":
                    by = self.number_or_vector()
                    par[key] = [by, by] if isinstance(by, float) else by
                elif key == "rotate":
                    par[key] = self.number()
                else:
                    par[key] = self.vector(2)
        elif self.next.text in PATTERNS and self.tokens[self.at + 1].text == "{":
            pattern = self.word()
            self.expect("{")
            table = {"a": None, "b": None} | PATTERNS[pattern]
            values = {}
            while not self.take("}"):
                key = self.word()
                if key not in table:
                    self.fail(f"{pattern} has no {key}")
                if key in ("a", "b"):
                    values[key] = self.values(group.width)
                else:
                    values[key] = self.parameter(table[key][0])
            for key, (_, default) in PATTERNS[pattern].items():
                if key not in values:
                    if default is REQUIRED:
                        self.fail(f"{key} is missing")
                    values[key] = default
            par |= {"how": pattern} | values
        elif self.next.text == "expression" and self.tokens[self.at + 1].text == "{":
            self.at += 1
            definitions, trees = self.block(group.width)
            par |= {"how": "expression", "definitions": definitions, "trees": trees}
        else:
            par |= {"how": "values", "values": self.values(group.width)}
        return Node("attribute", par, self.child())


def read(text, settings=None):
    return Parser(text, settings).scene()
