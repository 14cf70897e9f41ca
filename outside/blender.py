"""Whether Blender's importers read the files of a folder as they are meant, with their default options.

    python3.11 -m venv target/outside/blender && target/outside/blender/bin/pip install bpy==5.0.1
    target/outside/blender/bin/python outside/blender.py FOLDER

The folder is one of `files.py --keep`, whose expected.json says what the files show. Blender is z-up, and turns y-up files by itself:
in every format the coordinates are those of the scene.
"""

import json
import pathlib
import sys

import bpy
import numpy

IMPORTERS = {
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
}


def bounds(thing):
    """The bounds of an object in the world."""
    points = numpy.empty(3 * len(thing.data.vertices))
    thing.data.vertices.foreach_get("co", points)
    matrix = numpy.array(thing.matrix_world)
    world = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    return numpy.concatenate([world.min(axis=0), world.max(axis=0)])


def shows_colors(thing):
    """Whether a material takes its base colour from the colours of the vertices."""
    for material in filter(None, thing.data.materials):
        for node in material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                links = node.inputs["Base Color"].links
                return bool(links) and links[0].from_node.bl_idname == "ShaderNodeVertexColor"
    return False


def main(folder):
    expected = json.loads((folder / "expected.json").read_text())
    faults = []
    for file, told in expected.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        ending = file.rsplit(".", 1)[1]
        IMPORTERS[ending](str(folder / file))
        (thing,) = [one for one in bpy.data.objects if one.type == "MESH"]
        size = numpy.abs(told["bounds"]).max()
        if not numpy.allclose(bounds(thing), told["bounds"], rtol=0, atol=2e-6 * size):
            faults.append(f"{file}: bounds {bounds(thing)}, expected {told['bounds']}")
        if told["color"] is None or ending == "stl":
            continue
        if not thing.data.color_attributes:
            faults.append(f"{file}: no colours")
            continue
        # Blender gives linear numbers, and keeps those of GLB and PLY in bytes for a screen.
        colors = numpy.array([one.color[:3] for one in thing.data.color_attributes[0].data])
        if not numpy.allclose(colors, told["color"], rtol=0, atol=0.0045):
            faults.append(f"{file}: colour {colors[0]}, expected {told['color']}")
        # The importers of OBJ and PLY make no material; the colours are there for the viewport and for nodes.
        if ending == "glb" and not shows_colors(thing):
            faults.append(f"{file}: the material does not show the colours")
    for fault in faults:
        print("FAILED ", fault)
    print(f"{len(expected)} files, {len(faults)} faults, Blender {bpy.app.version_string}")
    return 1 if faults or not expected else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
