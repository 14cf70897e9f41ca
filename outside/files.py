"""Whether trimesh reads the meshes that jbt writes as they are meant.

Runs a jbt binary on scenes, in every format, loads the files with trimesh (process=True, which merges equal positions) and checks
against what jbt tells with --json:

* closed and wound in one way, after the merge, and with normals and texture coordinates left out of it;
* volume and area;
* upright: bounds after the transforms of the file's own scene, by the axis that `up` of --json names; --up says otherwise;
* colours: 188 for mid grey, and the same colours in all formats that have any.

    outside/files.py [JBT] [--keep FOLDER] [--only SCENE] [--resolution N]

--keep leaves the files in FOLDER, with `expected.json` for the other scripts: for each file the bounds of the model, the axis that
is up in it, and for a model of one colour that colour, linear.
"""

import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy
import trimesh

ROOT = pathlib.Path(__file__).resolve().parent.parent
FORMATS = ["glb", "obj", "ply", "stl"]
UP = {"glb": "y", "obj": "y", "ply": "z", "stl": "z"}

# No two of its sides are equal, it is not centred, and it has one colour.
BLOCK = """jbt 1
color ({color}) { box { center (0.1 0.2 0.7) half (0.4 0.2 0.8) radius 0.3 } }
"""
COLORS = {"grey": (0.5, 0.5, 0.5), "orange": (1.0, 0.25, 0.0)}

PARTICLES = 20_000
SEED = 5


def particles():
    """Balls at random places in a cube, as many and as close as those of a splash."""
    rng = random.Random(SEED)
    place = lambda: " ".join(f"{rng.uniform(-1, 1):.6f}" for _ in range(3))
    lines = [f"    point {{ at ({place()}) radius 0.08 }}" for _ in range(PARTICLES)]
    return "jbt 1\nsum {\n" + "\n".join(lines) + "\n}\n"


def light(screen):
    """From numbers for a screen to linear light: IEC 61966-2-1, from its text."""
    return numpy.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)


def turned(points, up):
    """Where points of a model, which is z-up, are in a file."""
    x, y, z = numpy.asarray(points, dtype=float).T
    return numpy.stack([x, z, -y] if up == "y" else [x, y, z], axis=-1)


def turned_bounds(bounds, up):
    corners = turned([bounds[:3], bounds[3:]], up)
    return numpy.array([corners.min(axis=0), corners.max(axis=0)])


class Judge:
    def __init__(self, jbt, folder):
        self.jbt, self.folder = jbt, folder
        self.failures, self.checks, self.expected = [], 0, {}

    def check(self, fine, file, what):
        self.checks += 1
        if not fine:
            self.failures.append(f"{file}: {what}")
            print(f"FAILED  {file}: {what}")

    def near(self, found, expected, tolerance, file, what):
        found, expected = numpy.asarray(found, dtype=float), numpy.asarray(expected, dtype=float)
        fine = found.shape == expected.shape and bool(numpy.all(numpy.abs(found - expected) <= tolerance))
        self.check(fine, file, f"{what}: found {found.tolist()}, expected {expected.tolist()}, within {tolerance}")

    def run(self, scene, file, *options):
        """Meshes a scene. What jbt tells about it."""
        command = [self.jbt, "mesh", scene, "-o", self.folder / file, "--json", *options]
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            raise SystemExit(f"{' '.join(map(str, command))}\n{ran.stderr}")
        return json.loads(ran.stdout)

    def load(self, file):
        """The mesh of a file as trimesh places it."""
        loaded = trimesh.load(self.folder / file, process=True)
        return loaded.to_geometry() if isinstance(loaded, trimesh.Scene) else loaded

    def solid(self, file, mesh, told):
        """Closed, and as large as it was told to be."""
        self.check(told["closed"], file, "jbt says that it is not closed")
        merged = mesh.copy()
        merged.merge_vertices(merge_tex=True, merge_norm=True)
        for name, one in [("as loaded", mesh), ("merged", merged)]:
            self.check(one.is_watertight, file, f"{name}: not watertight")
            self.check(one.is_winding_consistent, file, f"{name}: wound in two ways")
        if told["volume"] is None:
            return
        # Decimals of an OBJ are other reals than their f32, by half a unit of its last place.
        self.near(mesh.volume, told["volume"], 1e-6 * abs(told["volume"]), file, "volume")
        self.near(mesh.area, told["area"], 1e-6 * told["area"], file, "area")

    def upright(self, file, mesh, told):
        bounds = turned_bounds(told["bounds"], told["up"])
        self.near(mesh.bounds, bounds, 1e-6 * numpy.abs(bounds).max(), file, f"bounds, {told['up']} up")

    def colored(self, file, mesh):
        """Red, green and blue of each vertex, linear, 0 .. 1."""
        self.check(mesh.visual.kind == "vertex", file, f"colours of vertices, and not of kind {mesh.visual.kind}")
        colors = numpy.asarray(mesh.visual.vertex_colors, dtype=float)[:, :3] / 255
        return colors if file.endswith(".glb") else light(colors)

    def scene(self, name, scene, *options, color=None):
        """All that is asked of one scene."""
        palettes = {}
        for form in FORMATS:
            file = f"{name}.{form}"
            told = self.run(scene, file, *options)
            mesh = self.load(file)
            self.check(told["up"] == UP[form], file, f"{told['up']} is up")
            self.solid(file, mesh, told)
            self.upright(file, mesh, told)
            self.expected[file] = {"bounds": told["bounds"], "up": told["up"], "color": color}
            # trimesh drops the colours of OBJ and PLY with texture coordinates.
            if form != "stl" and (color is not None or mesh.visual.kind == "vertex"):
                palettes[file] = self.colored(file, mesh)
        # Half of the last of eight bits is 0.0045 of linear light, where it is most.
        for file, palette in palettes.items():
            if color is not None:
                self.near(palette.min(axis=0), color, 0.0045, file, "darkest colour")
                self.near(palette.max(axis=0), color, 0.0045, file, "brightest colour")
            mean = palettes[f"{name}.glb"].mean(axis=0)
            self.near(palette.mean(axis=0), mean, 0.0045, file, "mean colour, as in the GLB")
        print(f"{name}: {told['triangles']} triangles, volume {told['volume']}, area {told['area']}")

    def grey_bytes(self, scene):
        """Mid grey is 188 in the very bytes, and 128 where somebody wants it linear."""
        for file, options, byte in [
            ("grey.ply", [], 188),
            ("grey.obj", [], 188),
            ("grey.glb", [], 128),
            ("grey-linear.ply", ["--colors", "linear"], 128),
            ("grey-linear.obj", ["--colors", "linear"], 128),
            ("grey-srgb.glb", ["--colors", "srgb"], 188),
        ]:
            self.run(scene, file, "--resolution", "12", *options)
            colors = numpy.asarray(self.load(file).visual.vertex_colors)[:, :3]
            self.check(bool(numpy.all(colors == byte)), file, f"bytes {numpy.unique(colors)}, expected {byte}")

    def other_ups(self, scene):
        for form in FORMATS:
            for up in ["y", "z"]:
                file = f"up-{up}.{form}"
                told = self.run(scene, file, "--resolution", "12", "--up", up)
                self.check(told["up"] == up, file, f"{told['up']} is up")
                self.upright(file, self.load(file), told)


def scenes(judge, only, resolution):
    for name, color in COLORS.items():
        scene = judge.folder / f"{name}.jbt"
        scene.write_text(BLOCK.replace("{color}", " ".join(map(str, color))))
        if only in (None, name):
            judge.scene(name, scene, "--resolution", "32", color=color)
    if only is None:
        judge.grey_bytes(judge.folder / "grey.jbt")
        judge.other_ups(judge.folder / "grey.jbt")
    for scene in sorted((ROOT / "examples").glob("*.jbt")):
        if only in (None, scene.stem):
            judge.scene(scene.stem, scene, "--resolution", str(resolution))
    if only in (None, "particles"):
        scene = judge.folder / "particles.jbt"
        scene.write_text(particles())
        judge.scene("particles", scene, "--cell", "0.03")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("jbt", nargs="?", type=pathlib.Path, default=ROOT / "target/release/jbt")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="where the files stay")
    parser.add_argument("--only", metavar="SCENE", help="an example by its name, grey, orange, or particles")
    parser.add_argument("--resolution", type=int, default=40, help="cells along the longest side of an example")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        judge = Judge(arguments.jbt, folder)
        scenes(judge, arguments.only, arguments.resolution)
        (folder / "expected.json").write_text(json.dumps(judge.expected, indent=1) + "\n")
    print(f"{judge.checks} checks, {len(judge.failures)} failed, trimesh {trimesh.__version__}")
    return 1 if judge.failures else 0


if __name__ == "__main__":
    sys.exit(main())
