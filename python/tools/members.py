#!/usr/bin/env python3
"""Writes lib/jbt/_members.py: a function or method for each member of Rust's lists.

Names, parameters, ranges and defaults come from the native module, formulas and meanings from the pages of
docs/, which tests hold to the same lists. tests/test_members.py compares the file with what this would write.

    python python/tools/members.py [path of the native module]
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import re
import sys
import textwrap
from pathlib import Path
from typing import Any, TypeAlias

HERE = Path(__file__).resolve().parent
DOCS = HERE.parent.parent / "docs"
OUTPUT = HERE.parent / "lib" / "jbt" / "_members.py"
WIDTH = 100

PAGES = {
    "skeleton": "skeletons",
    "falloff": "falloffs",
    "operator": "operators",
    "map": "warps",
    "warp": "warps",
    "texture": "attributes",
}

# The type of a parameter, what it may be, and a value for examples, by its kind.
KINDS: dict[str, tuple[str, str, str]] = {
    "real": ("Real", "any number", "{number}"),
    "positive": ("Real", "a number > 0", "{number}"),
    "non_negative": ("Real", "a number >= 0", "{number}"),
    "within": ("Real", "{} .. {}", "{mean}"),
    "choice": ("str", "one of {words}", "{last}"),
    "count": ("Real", "a whole number >= 0", "3"),
    "whole": ("int", "a whole number, {} .. {}", "{most}"),
    "degrees": ("Real", "0 .. 360", "90"),
    "position": ("Vector", "3 numbers", "(0.1, 0.2, {place})"),
    "extents": ("Vector", "3 numbers >= 0", "(0.3, 0.2, 0.1)"),
    "stretches": ("Vector", "3 numbers > 0", "(1, 2, 3)"),
    "direction": ("Axis | Vector", '3 numbers, not all 0, or "x", "y", "z"', '"y"'),
    "axis": ("Axis | Vector", '"x", "y" or "z"', '"x"'),
    "positions": ("Points", "points", "[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]"),
    "lengths": ("Reals", "numbers >= 0", "[0.1]"),
    "flag": ("bool", "True or False", "True"),
    "rows": ("Matrix", "3 rows of 4 numbers", "[(1, 0, 0, 2), (0, 1, 0, 0), (0, 0, 1, 0)]"),
}

HEAD = '''"""What there is to build with. tools/members.py wrote it from the lists of Rust and docs/."""

# fmt: off

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

from ._calls import apply, falloff_of, function, operator, pattern, primitive
from ._jbt import Falloff, Number, Pattern, Term
from ._types import Axis, FalloffLike, Formula, Matrix, Models, Points, Real, Reals, Vector

if TYPE_CHECKING:
    from ._model import Model

'''

PRIMITIVE = [
    (
        "radius",
        "where the field reaches zero, the support radius; a number > 0. This or the next one.",
    ),
    ("surface_radius", "where the surface of this primitive alone is; a number > 0."),
    ("falloff", 'how the field fades: a falloff, or the name of one; default "soft".'),
    ("strength", "a factor of the field; any number, default 1. A negative one carves in sums."),
    ("color", "linear red, green and blue."),
]
PRIMITIVE_ARGUMENTS = (
    "radius: Real | None = None, surface_radius: Real | None = None, "
    'falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None'
)


def native(path: str | None = None) -> Any:
    """The native module: that of a path, or of the last build."""
    file = path or str(HERE.parent.parent / "target" / "release" / "lib_jbt.so")
    loader = importlib.machinery.ExtensionFileLoader("_jbt", file)
    spec = importlib.util.spec_from_file_location("_jbt", file, loader=loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


class Field:
    """A parameter for Python."""

    def __init__(self, row: tuple[str, str, str, list[str], str | None], place: int) -> None:
        _, self.word, kind, words, self.default = row
        self.name = self.word + "_" if self.word == "from" else self.word
        self.type, values, example = KINDS[kind]
        if kind == "choice":
            self.type = "Literal[" + ", ".join(f'"{word}"' for word in words) + "]"
            self.values = values.format(words=", ".join(words))
            self.example = f'"{words[-1]}"'
        elif words:
            self.values = values.format(*words)
            mean = (float(words[0]) + float(words[1])) / 2
            self.example = example.format(mean=mean, most=words[1])
        else:
            self.values = values
            self.example = example.format(place=f"0.{3 + place}", number=0.25 + place / 2)

    def parameter(self) -> str:
        return f"{self.name}: {self.type}" + (f" = {self.default}" if self.default is not None else "")


def parameters(fields: list[Field]) -> str:
    """The parameters of a signature. Behind one with a default, those without have to be named."""
    written: list[str] = []
    starred = False
    for place, field in enumerate(fields):
        if not starred and field.default is None and any(f.default is not None for f in fields[:place]):
            written.append("*")
            starred = True
        written.append(field.parameter())
    return ", ".join(written)


def call(fields: list[Field], *, named: bool = False) -> str:
    """Examples for all parameters, as arguments."""
    written: list[str] = []
    for place, field in enumerate(fields):
        named = named or (field.default is None and any(f.default is not None for f in fields[:place]))
        written.append(f"{field.name}={field.example}" if named else field.example)
    return ", ".join(written)


def section(page: str, word: str) -> list[str]:
    """The lines of a member's section."""
    lines = page.splitlines()
    start = lines.index(f"### `{word}`") + 1
    end = next((n for n in range(start, len(lines)) if lines[n].startswith("#")), len(lines))
    return lines[start:end]


def prose(lines: list[str]) -> list[str]:
    """Paragraphs of a section as plain text, without pictures, tables and code."""
    text = re.sub(r"```.*?```", "", "\n".join(lines), flags=re.S)
    paragraphs = [" ".join(part.split()) for part in text.split("\n\n")]
    kept = [part for part in paragraphs if part and not part.startswith(("[![", "|", "<"))]
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", part) for part in kept]
    return [part.replace("\\|", "|").replace("`", "``") for part in plain]


def meanings(lines: list[str]) -> dict[str, str]:
    """The last column of a section's table, by parameter."""
    found = {}
    for line in lines:
        row = re.match(r"\| `(\w+)` \|.*\| ([^|]*) \|$", line)
        if row:
            found[row[1]] = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", row[2]).replace("`", "``")
    return found


def wrapped(text: str, indent: int, hang: int = 0) -> list[str]:
    first, rest = " " * indent, " " * (indent + hang)
    return textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False)


def docstring(
    paragraphs: list[str], arguments: list[tuple[str, str]], example: list[str], indent: int
) -> list[str]:
    """A docstring: what it is, its arguments, a doctest."""
    pad = " " * indent
    lines = wrapped('r"""' + (paragraphs[0] if paragraphs else ""), indent)
    for part in paragraphs[1:]:
        lines += ["", *wrapped(part, indent)]
    if arguments:
        lines += ["", f"{pad}Args:"]
        for name, about in arguments:
            lines += wrapped(f"{name}: {about}", indent + 4, 4)
    if example:
        lines += ["", *[pad + line if line else "" for line in example]]
    return [*lines, f'{pad}"""']


def about(field: Field, meaning: dict[str, str]) -> tuple[str, str]:
    text = f"{meaning[field.word]}; {field.values}" if field.word in meaning else field.values
    shown = "required" if field.default is None else f"default {field.default}"
    return field.name, f"{text}, {shown}."


def doctest(code: str, output: str) -> list[str]:
    """An example with what it prints: blank lines would end it."""
    return [">>> import jbt", f">>> {code}", *[line.rstrip() for line in output.splitlines() if line.strip()]]


Row: TypeAlias = dict[str, Any]
Fields: TypeAlias = list[Field]
Words: TypeAlias = list[str]
Lines: TypeAlias = list[str]
Arguments: TypeAlias = list[tuple[str, str]]


class Writer:
    def __init__(self, module: Any) -> None:
        self.module = module
        self.pages = {page: (DOCS / f"{page}.md").read_text() for page in {*PAGES.values(), "expressions"}}

    def values(self, fields: list[Field]) -> list[Any]:
        return [eval(field.example) for field in fields]

    def ball(self) -> Any:
        return self.skeletal("point", [(0, 0, 0)])

    def skeletal(self, name: str, values: list[Any]) -> Any:
        soft = self.module.Falloff.named("soft")
        return self.module.Model.primitive(name, values, ("radius", 1.0), soft, 1.0)

    def member(self, row: dict[str, Any]) -> list[str]:
        """A function or method for a member."""
        family, name = row["family"], row["name"]
        fields = [Field(field, place) for place, field in enumerate(row["fields"])]
        lines = section(self.pages[PAGES[family]], row["word"])
        words = prose(lines)
        arguments = [about(field, meanings(lines)) for field in fields]
        writer: Any = {
            "skeleton": self.skeleton,
            "falloff": self.falloff,
            "operator": self.operator,
            "map": self.map,
            "warp": self.warp,
            "texture": self.texture,
        }[family]
        lines = writer(name, row, fields, words, arguments)
        return list(lines)

    def function_of(
        self, name: str, given: str, returns: str, body: str, doc: tuple[Any, Any, Any], indent: int = 0
    ) -> list[str]:
        pad = " " * indent
        head = f"{pad}def {name}({given}) -> {returns}:"
        return [
            head,
            *docstring(*doc, indent + 4),
            f"{pad}    return {body}",
            "",
            *([""] if not indent else []),
        ]

    def listed(self, fields: list[Field]) -> str:
        return "[" + ", ".join(field.name for field in fields) + "]"

    # One method for each family: the name, the row, its fields, paragraphs, arguments.

    def map(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        text = self.ball().map(name, self.values(fields)).text()
        return self.method("map", name, fields, words, arguments, text)

    def warp(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        text = self.ball().warp(name, self.values(fields)).text()
        return self.method("warp", name, fields, words, arguments, text)

    def method(
        self, family: str, name: str, fields: Fields, words: Words, arguments: Arguments, text: str
    ) -> Lines:
        example = doctest(f"print(jbt.point(radius=1).{name}({call(fields)}))", text)
        given = "self" + (f", {parameters(fields)}" if fields else "")
        body = f'apply(self, "{family}", "{name}", {self.listed(fields)})'
        return self.function_of(name, given, "Model", body, (words, arguments, example), 4)

    def operator(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        count = 1 if row["takes_one"] else 2
        text = self.module.Model.combine(name, self.values(fields), [self.ball()] * count).text()
        if row["takes_one"]:
            return self.method("operator", name, fields, words, arguments, text)
        others = ", " + call(fields, named=True) if fields else ""
        code = f"ball = jbt.point(radius=1); print(jbt.{name}(ball, ball{others}))"
        given = "*models: Models" + (f", {', '.join(f.parameter() for f in fields)}" if fields else "")
        models = ("models", "models, or lists of them; at least one.")
        body = f'operator("{name}", {self.listed(fields)}, models)'
        return self.function_of(
            name, given, "Model", body, (words, [models, *arguments], doctest(code, text))
        )

    def falloff(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        shown = repr(self.module.Falloff(name, self.values(fields)))
        example = doctest(f"jbt.{name}({call(fields)})", shown)
        body = f'falloff_of("{name}", {self.listed(fields)})'
        return self.function_of(name, parameters(fields), "Falloff", body, (words, arguments, example))

    def texture(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        pattern = self.module.Pattern(name, self.values(fields))
        text = self.ball().textured("rough", pattern, 0, 1).text()
        code = f'print(jbt.point(radius=1).textured("rough", jbt.{name}({call(fields)}), 0, 1))'
        body = f'pattern("{name}", {self.listed(fields)})'
        return self.function_of(
            name, parameters(fields), "Pattern", body, (words, arguments, doctest(code, text))
        )

    def skeleton(self, name: str, row: Row, fields: Fields, words: Words, arguments: Arguments) -> Lines:
        text = self.skeletal(name, self.values(fields)).text()
        example = doctest(f"print(jbt.{name}({call(fields)}{', ' if fields else ''}radius=1))", text)
        given = parameters(fields)
        star = "" if "*, " in given else "*, "
        given = f"{given}{', ' if given else ''}{star}{PRIMITIVE_ARGUMENTS}"
        body = f'primitive("{name}", {self.listed(fields)}, radius, surface_radius, falloff, strength, color)'
        return self.function_of(name, given, "Model", body, (words, [*arguments, *PRIMITIVE], example))

    def formula(self, name: str, least: int, most: int) -> list[str]:
        """A function of formulas, with a signature for each place of the first operand that is no number."""
        rows = [line for line in self.pages["expressions"].splitlines() if line.startswith("| `")]
        cells = next(line.split(" | ") for line in rows if f"`{name}(" in line.split(" | ")[0])
        written = re.search(rf"`{name}\(([^)]*)\)`", cells[0])
        assert written is not None
        named = [word.strip() for word in written[1].split(",")]
        meaning = cells[1].strip() or f"{name}({written[1]})"
        words = [f"``{name}({written[1]})``: {meaning}".replace("`", "``").replace("````", "``") + "."]
        if cells[2].strip():
            words.append("Where it has no value, or a kink: " + cells[2].strip().replace("`", "``") + ".")
        if most > 3 or ".." in named:
            signatures = [("*values: Real", "Number"), ("*values: Formula", "Term")]
            given, passed = "*values: Formula", "*values"
        else:
            kinds = [
                ["Real"] * place + ["Term"] + ["Formula"] * (least - place - 1) for place in range(least)
            ]
            kinds.append(["Real"] * least)
            signatures = []
            for row in kinds:
                signature = ", ".join(f"{n}: {kind}" for n, kind in zip(named, row, strict=True))
                signatures.append((signature, "Term" if "Term" in row else "Number"))
            given, passed = ", ".join(f"{n}: Formula" for n in named), ", ".join(named)
        lines = []
        for signature, returns in signatures:
            loose = "  # type: ignore[overload-overlap]" if signature == "*values: Real" else ""
            lines += ["@overload", f"def {name}({signature}) -> {returns}: ...{loose}"]
        examples = [0.25, 0.5, 0.75][: max(least, 1)]
        value = self.module.call(name, examples).value
        shown = ", ".join(map(str, examples))
        example = [">>> import jbt", f">>> float(jbt.{name}({shown}))", repr(value)]
        doc = docstring(words, [], example, 4)
        body = f'    return function("{name}", {passed})'
        return [*lines, f"def {name}({given}) -> Any:", *doc, body, "", ""]

    def whole(self) -> str:
        rows = self.module.members()
        lines: list[str] = []
        names: list[str] = []
        methods: list[str] = []
        for row in rows:
            is_method = row["takes_one"]
            written = self.member(row)
            if is_method:
                methods += written
            else:
                lines += written
                names.append(row["name"])
        for name, least, most in self.module.functions():
            lines += self.formula(name, least, most)
            names.append(name)
        about = '    """Maps, warps and operators of one model, as methods of it."""'
        lines += ["class ModelMembers:", about, ""]
        lines += ["    __slots__ = ()", "", *methods]
        exported = ["__all__ = [", *[f'    "{name}",' for name in ["ModelMembers", *names]], "]", "", ""]
        return HEAD + "\n".join([*exported, *lines]).rstrip() + "\n"


def text(module: Any) -> str:
    """The text of _members.py for a native module."""
    return Writer(module).whole()


if __name__ == "__main__":
    OUTPUT.write_text(text(native(*sys.argv[1:2])))
