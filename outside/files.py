"""Whether other programs read the files that jbt writes as they are meant.

Runs a jbt binary on scenes, in every format, loads the files with trimesh (process=True, which merges equal positions) and checks
against what jbt tells with --json. 3MF is read by lib3mf in its strict mode, which has to warn of nothing, and USDA by Pixar's
usd-core, whose validators have to find nothing; the meshes that they see are judged as the others are:

* closed and wound in one way, after the merge, and with normals and texture coordinates left out of it;
* volume and area;
* upright: bounds after the transforms of the file's own scene, by the axis that `up` of --json names; --up says otherwise;
* colours: 188 for mid grey, and the same colours in all formats that have any;
* what --simplify, --flat-bottom, --sharp and --color-by make of a mesh, and the materials of --palette;
* volumes: pyopenvdb of the system's Python sees in a .vdb the numbers of the .npy, and no others (skipped where it is not
  installed: apt-get install python3-openvdb).

    outside/files.py [JBT] [--keep FOLDER] [--only SCENE] [--resolution N]

--keep leaves the files in FOLDER, with `expected.json` for the other scripts: for each file the bounds of the model, the axis that
is up in it, and for a model of one colour that colour, linear.
"""

import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import lib3mf
import numpy
import trimesh
from pxr import Usd, UsdGeom, UsdValidation

ROOT = pathlib.Path(__file__).resolve().parent.parent
FORMATS = ["glb", "obj", "ply", "stl", "3mf", "usda"]
UP = {"glb": "y", "obj": "y", "ply": "z", "stl": "z", "3mf": "z", "usda": "z"}
LINEAR = (".glb", ".usda")
# Those that the other scripts read too.
OTHERS = ["glb", "obj", "ply", "stl"]

# No two of its sides are equal, it is not centred, and it has one colour.
BLOCK = """jbt 1
color ({color}) { box { center (0.1 0.2 0.7) half (0.4 0.2 0.8) radius 0.3 } }
"""
COLORS = {"grey": (0.5, 0.5, 0.5), "orange": (1.0, 0.25, 0.0)}

# Runs in the system's Python: numbers of each grid of a volume, as arrays, and what is said of them.
VOLUME = """
import json, sys, numpy, pyopenvdb
folder, shape = sys.argv[1], tuple(map(int, sys.argv[2:]))
grids, _ = pyopenvdb.readAll(folder + "/volume.vdb")
told = {"classes": {}, "active": {}}
for grid in grids:
    wide = () if grid.valueTypeName == "float" else (3,)
    array = numpy.zeros(shape + wide, dtype=numpy.float32)
    grid.copyToArray(array)
    numpy.save(folder + "/volume-" + grid.name + ".npy", array)
    told["classes"][grid.name], told["active"][grid.name] = grid.gridClass, grid.activeVoxelCount()
    told["voxel"], told["first"] = grid.transform.voxelSize(), grid.transform.indexToWorld((0, 0, 0))
json.dump(told, open(folder + "/volume.json", "w"))
"""

# The same of a level set of a ball around (10, 0, 0), and what a program for level sets makes of it.
LEVELS = """
import collections, json, sys, numpy, pyopenvdb
folder = sys.argv[1]
grids, _ = pyopenvdb.readAll(folder + "/surface.vdb")
grids = {grid.name: grid for grid in grids}
surface = grids["surface"]
at = lambda index: numpy.linalg.norm(numpy.array(surface.transform.indexToWorld(index)) - [10, 0, 0]) - 1
off = [(abs(value.value - at(value.min)), abs(value.value)) for value in surface.citerOnValues()]
accessor = surface.getConstAccessor()
index = lambda place: tuple(round(x) for x in surface.transform.worldToIndex(place))
sign = lambda place: float(numpy.sign(accessor.getValue(index(place))))
points, quads = surface.convertToQuads()
radii = numpy.linalg.norm(points - [10, 0, 0], axis=1)
edges = collections.Counter(tuple(sorted(edge)) for quad in quads.tolist() for edge in zip(quad, quad[1:] + quad[:1]))
told = {"class": surface.gridClass, "names": sorted(grids), "background": surface.background, "active": surface.activeVoxelCount(),
        "colors": grids["color"].activeVoxelCount(), "worst": max(d for d, _ in off), "near": max(d for d, v in off if v < 0.005),
        "signs": [sign((10, 0, 0)), sign((11.1, 0, 0)), sign((100, 0, 0))], "quads": len(quads),
        "low": float(radii.min()), "high": float(radii.max()), "open": sum(count != 2 for count in edges.values())}
json.dump(told, open(folder + "/surface.json", "w"))
"""

PARTICLES = 20_000
SEED = 5


def particles():
    """Balls at random places in a cube, as many and as close as those of a splash."""
    rng = random.Random(SEED)
    place = lambda: " ".join(f"{rng.uniform(-1, 1):.6f}" for _ in range(3))
    lines = [f"    point {{ at ({place()}) radius 0.08 }}" for _ in range(PARTICLES)]
    return "jbt 1\nsum {\n" + "\n".join(lines) + "\n}\n"


def skip(reason):
    """Notes for the last line of .ci/run what could not be asked."""
    print(f"skipped: {reason}")
    if notes := os.environ.get("JBT_SKIPPED"):
        with open(notes, "a", encoding="utf-8") as file:
            file.write(f"{reason}\tfiles.py\n")


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
        """The mesh of a file as its reader places it."""
        if file.endswith(".3mf"):
            return self.load_3mf(file)
        if file.endswith(".usda"):
            return self.load_usda(file)
        loaded = trimesh.load(self.folder / file, process=True)
        return loaded.to_geometry() if isinstance(loaded, trimesh.Scene) else loaded

    def load_3mf(self, file):
        library = lib3mf.get_wrapper()
        model = library.CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(True)
        reader.ReadFromFile(str(self.folder / file))
        warnings = [reader.GetWarning(index) for index in range(reader.GetWarningCount())]
        self.check(not warnings, file, f"lib3mf warns: {warnings}")
        self.check(model.GetUnit() == lib3mf.ModelUnit.MilliMeter, file, f"the unit is {model.GetUnit()}")
        groups, colors = model.GetColorGroups(), {}
        while groups.MoveNext():
            group = groups.GetCurrentColorGroup()
            for index in group.GetAllPropertyIDs():
                color = group.GetColor(index)
                colors[group.GetResourceID(), index] = (color.Red, color.Green, color.Blue, color.Alpha)
        objects = model.GetMeshObjects()
        self.check(objects.Count() == 1 and objects.MoveNext(), file, f"{objects.Count()} objects")
        mesh = objects.GetCurrentMeshObject()
        self.check(mesh.IsManifoldAndOriented(), file, "lib3mf says that it is not manifold and oriented")
        places = numpy.array([tuple(vertex.Coordinates) for vertex in mesh.GetVertices()], dtype=float)
        triangles = numpy.array([tuple(triangle.Indices) for triangle in mesh.GetTriangleIndices()], dtype=int)
        if not colors:
            return trimesh.Trimesh(places, triangles)
        vertex_colors = numpy.zeros((len(places), 4), dtype=numpy.uint8)
        for triangle, properties in zip(triangles, mesh.GetAllTriangleProperties()):
            for vertex, place in zip(triangle, properties.PropertyIDs):
                vertex_colors[vertex] = colors[properties.ResourceID, place]
        return trimesh.Trimesh(places, triangles, vertex_colors=vertex_colors)

    def load_usda(self, file):
        stage = Usd.Stage.Open(str(self.folder / file))
        validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
        errors = UsdValidation.ValidationContext(validators).Validate(stage)
        self.check(not errors, file, f"usd-core finds {[error.GetMessage() for error in errors]}")
        self.check(UsdGeom.GetStageMetersPerUnit(stage) == 1.0, file, f"{UsdGeom.GetStageMetersPerUnit(stage)} m a unit")
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/model/mesh"))
        placed = numpy.array(UsdGeom.XformCache().GetLocalToWorldTransform(mesh.GetPrim()))
        places = numpy.array(mesh.GetPointsAttr().Get(), dtype=float) @ placed[:3, :3] + placed[3, :3]
        triangles = numpy.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=int).reshape(-1, 3)
        colors = mesh.GetDisplayColorAttr().Get()
        if not colors:
            return trimesh.Trimesh(places, triangles)
        return trimesh.Trimesh(places, triangles, vertex_colors=numpy.round(numpy.array(colors) * 255).astype(numpy.uint8))

    def solid(self, file, mesh, told):
        """Closed, and as large as it was told to be."""
        self.check(told["closed"], file, "jbt says that it is not closed")
        merged = mesh.copy()
        merged.merge_vertices(merge_tex=True, merge_norm=True)
        # Vertices on edges are there once for each side.
        for name, one in [("merged", merged)] if told["sharp_vertices"] else [("as loaded", mesh), ("merged", merged)]:
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
        return colors if file.endswith(LINEAR) else light(colors)

    def scene(self, name, scene, *options, color=None):
        """All that is asked of one scene."""
        palettes = {}
        for form in FORMATS:
            file = f"{name}.{form}"
            # Colours are compared without edges: there vertices are apart by format, and trimesh joins some of them.
            self.run(scene, file, *options, "--sharp", "off")
            cut = self.load(file)
            told = self.run(scene, file, *options)
            mesh = self.load(file)
            self.check(told["up"] == UP[form], file, f"{told['up']} is up")
            self.solid(file, mesh, told)
            self.upright(file, mesh, told)
            if form in OTHERS:
                self.expected[file] = {"bounds": told["bounds"], "up": told["up"], "color": color}
            # trimesh drops the colours of OBJ and PLY with texture coordinates.
            if form != "stl" and (color is not None or cut.visual.kind == "vertex"):
                palettes[file] = self.colored(file, cut)
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
            ("grey.3mf", [], 188),
            ("grey.usda", [], 128),
            ("grey-linear.ply", ["--colors", "linear"], 128),
            ("grey-linear.obj", ["--colors", "linear"], 128),
            ("grey-srgb.glb", ["--colors", "srgb"], 188),
        ]:
            self.run(scene, file, "--resolution", "12", *options)
            colors = numpy.asarray(self.load(file).visual.vertex_colors)[:, :3]
            self.check(bool(numpy.all(colors == byte)), file, f"bytes {numpy.unique(colors)}, expected {byte}")

    def volumes(self, scene):
        """A sparse volume has the numbers of the array. The module is one of the system's own Python."""
        python = "/usr/bin/python3"
        has_it = [python, "-c", "import pyopenvdb, numpy"]
        if subprocess.run(has_it, capture_output=True, check=False).returncode != 0:
            skip(f"{python} has no pyopenvdb or numpy: apt-get install python3-openvdb python3-numpy")
            return
        for file in ["volume.vdb", "volume.npy"]:
            command = [self.jbt, "sample", scene, "-o", self.folder / file, "--query", "all", "--resolution", "48", "--json"]
            told = json.loads(subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout)
        dense = numpy.load(self.folder / "volume.npy")
        subprocess.run([python, "-c", VOLUME, str(self.folder), *map(str, dense.shape[:3])], check=True)
        cell, low = told["cell"], told["region"][:3]
        found = json.loads((self.folder / "volume.json").read_text())
        self.near(found["voxel"], [cell] * 3, 1e-12, "volume.vdb", "edges of a voxel")
        self.near(found["first"], low, 1e-6, "volume.vdb", "place of the first point")
        self.check(found["classes"]["density"] == "fog volume", "volume.vdb", f"classes {found['classes']}")
        inside = dense[..., 0] != 0
        for name, planes in [("density", dense[..., 0]), ("gradient", dense[..., 1:4]), ("color", dense[..., 4:7])]:
            read = numpy.load(self.folder / f"volume-{name}.npy")
            self.check(found["active"][name] == int(inside.sum()), "volume.vdb", f"{found['active'][name]} points of {name} are active")
            self.check(bool(numpy.array_equal(read[inside], planes[inside])), "volume.vdb", f"{name} has other numbers")
            self.check(not read[~inside].any(), "volume.vdb", f"{name} has numbers where the field is 0")
        print(f"volume.vdb: {int(inside.sum())} active points")
        self.level_set(python)

    def level_set(self, python):
        """A ball of radius 1, of which distances are known, and what pyopenvdb meshes of them."""
        scene = self.folder / "ball.jbt"
        scene.write_text("jbt 1 color (1 0.5 0.25) { point { at (10 0 0) surface_radius 1 } }\n", encoding="utf-8")
        command = [self.jbt, "sample", scene, "-o", self.folder / "surface.vdb", "--level-set", "--query", "all", "--cell", "0.01"]
        subprocess.run([str(word) for word in command], capture_output=True, check=True)
        subprocess.run([python, "-c", LEVELS, str(self.folder)], check=True)
        told = json.loads((self.folder / "surface.json").read_text())
        self.check(told["class"] == "level set", "surface.vdb", f"the class is {told['class']}")
        self.check(told["names"] == ["color", "surface"], "surface.vdb", f"grids {told['names']}")
        self.near([told["background"]], [0.03], 1e-8, "surface.vdb", "background")
        # Exact at the surface, and to first order beside it.
        self.check(told["near"] < 2e-5, "surface.vdb", f"distances within half a cell are off by {told['near']}")
        self.check(told["worst"] < 1e-4, "surface.vdb", f"distances are off by {told['worst']}")
        self.check(told["signs"] == [-1.0, 1.0, 1.0], "surface.vdb", f"signs {told['signs']} in the middle and outside")
        self.check(told["active"] > 50_000 and told["colors"] == told["active"], "surface.vdb", f"{told['active']}, {told['colors']} active")
        self.check(abs(told["low"] - 1) < 1e-4 and abs(told["high"] - 1) < 1e-4, "surface.vdb", f"radii of its mesh from {told['low']} to {told['high']}")
        self.check(told["open"] == 0, "surface.vdb", f"{told['open']} edges of its mesh have not two sides")
        print(f"surface.vdb: {told['active']} active points, distances off by {told['worst']:.1e} at most, {told['quads']} quads")

    def other_ups(self, scene):
        for form in FORMATS:
            for up in ["y", "z"]:
                file = f"up-{up}.{form}"
                told = self.run(scene, file, "--resolution", "12", "--up", up)
                self.check(told["up"] == up, file, f"{told['up']} is up")
                self.upright(file, self.load(file), told)


    def changed(self, scene):
        """Meshes that options change: fewer triangles, a flat bottom, edges, colours by an attribute."""
        whole = self.run(scene, "whole.glb", "--resolution", "48")
        for form in FORMATS:
            for name, options in [("simple", ["--simplify", "25%"]), ("flat", ["--flat-bottom", "0.3"]), ("cut", ["--sharp", "off"]),
                                  ("by", ["--color-by", "rough", "--ramp", "grey"])]:
                file = f"{name}.{form}"
                if name == "by" and form == "stl":
                    continue
                told = self.run(scene, file, "--resolution", "48", *options)
                mesh = self.load(file)
                # The validators of a solid are asked about vertices that are apart at edges, too.
                self.solid(file, mesh, told)
                self.upright(file, mesh, told)
                if name == "simple":
                    share = told["triangles"] / whole["triangles"]
                    self.check(share <= 0.25, file, f"{share} of the triangles are left")
                if name == "flat":
                    self.flat(file, mesh, told, whole)
                if name == "by":
                    colors = self.colored(file, mesh)
                    self.check(bool(numpy.all(numpy.ptp(colors, axis=1) < 0.005)), file, "the ramp is grey")
                    self.check(colors.min() < 0.01 and colors.max() > 0.99, file, f"colours from {colors.min()} to {colors.max()}")

    def flat(self, file, mesh, told, whole):
        """It is cut where it should be, and stands on its bottom."""
        axis = 1 if told["up"] == "y" else 2
        self.near(mesh.bounds[0][axis], whole["bounds"][2] + 0.3, 1e-3, file, "the lowest point")
        lowest = numpy.abs(mesh.triangles[:, :, axis] - mesh.bounds[0][axis]).max(axis=1) < 1e-3
        area = mesh.area_faces[lowest].sum()
        self.check(area > 0.01 * mesh.area and bool(numpy.all(mesh.face_normals[lowest][:, axis] < -0.99)), file, f"a bottom of {area}")

    def materials(self, scene):
        """Base materials of a 3MF file: as many as were asked for, and a triangle has one."""
        for most in [1, 4]:
            file = f"palette-{most}.3mf"
            told = self.run(scene, file, "--resolution", "32", "--palette", str(most))
            self.solid(file, self.load(file), told)
            library = lib3mf.get_wrapper()
            model = library.CreateModel()
            model.QueryReader("3mf").ReadFromFile(str(self.folder / file))
            groups, objects = model.GetBaseMaterialGroups(), model.GetMeshObjects()
            self.check(groups.MoveNext() and objects.MoveNext(), file, "no materials, or no mesh")
            count = groups.GetCurrentBaseMaterialGroup().GetCount()
            self.check(1 <= count <= most, file, f"{count} materials")
            mesh = objects.GetCurrentMeshObject()
            used = [tuple(properties.PropertyIDs) for properties in mesh.GetAllTriangleProperties()]
            self.check(all(len(set(each)) == 1 for each in used), file, "a triangle has several materials")
            self.check(len(set(used)) == count, file, f"{len(set(used))} of {count} materials are used")


def scenes(judge, only, resolution):
    for name, color in COLORS.items():
        scene = judge.folder / f"{name}.jbt"
        scene.write_text(BLOCK.replace("{color}", " ".join(map(str, color))))
        if only in (None, name):
            judge.scene(name, scene, "--resolution", "32", color=color)
    if only is None:
        judge.grey_bytes(judge.folder / "grey.jbt")
        judge.other_ups(judge.folder / "grey.jbt")
        judge.volumes(ROOT / "examples/hero.jbt")
        judge.changed(ROOT / "examples/attributes.jbt")
        judge.materials(ROOT / "examples/koi.jbt")
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
