# Run by Blender: opens a glTF or BVH file and compares where bones begin with where joints should be, and vertices of a
# mesh where some are given.
#   blender -b --python compare_in_blender.py -- FILE EXPECTED.json ANSWER.json
# EXPECTED: [{"motion": name, "times": [s], "joints": [name], "places": [[[x, y, z] m]],
#             "mesh": name or "", "vertices": [[[x, y, z] m]]}], X forward, Z up.
import json
import sys

import bpy
import numpy

# Debian 12's Blender 3.4 is older than its Python 3.11 and numpy 1.24: its importers ask these for what they have no more.
if "bool" not in numpy.__dict__:
    numpy.bool = bool


def open_without_universal_newlines(path, mode="r", **options):
    return open(path, mode.replace("U", ""), **options)


file, expected, answer = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = 60
if file.endswith(".bvh"):
    import io_anim_bvh.import_bvh
    io_anim_bvh.import_bvh.open = open_without_universal_newlines
    # Blender takes the file's frames as its own, one by one.
    bpy.ops.import_anim.bvh(filepath=file, axis_forward="-Z", axis_up="Y", use_fps_scale=False,
                            update_scene_fps=True, rotate_mode="QUATERNION")
else:
    bpy.ops.import_scene.gltf(filepath=file)
tracks = json.load(open(expected))
for thing in list(bpy.data.objects):
    if thing.type == "MESH" and not any(thing.name == track["mesh"] for track in tracks):
        bpy.data.objects.remove(thing)  # nobody looks at it
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
animation = armature.animation_data
animation.use_nla = False


def action_of(motion):
    if file.endswith(".bvh"):
        return animation.action
    return next(a for a in bpy.data.actions if a.name == motion or a.name.startswith(motion + "_" + armature.name))


def apart(blender, place):
    # Blender looks along -Y where glTF looks along Z.
    return max(abs(-blender.y - place[0]), abs(blender.x - place[1]), abs(blender.z - place[2]))


def skin(name):
    mesh = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [mesh.matrix_world @ vertex.co for vertex in mesh.to_mesh().vertices]


found = []
for track in tracks:
    animation.action = action_of(track["motion"])
    missing = [name for name in track["joints"] if name not in armature.pose.bones]
    assert not missing, missing
    rate = scene.render.fps / scene.render.fps_base
    largest, where = 0, ""
    for k, (time, places) in enumerate(zip(track["times"], track["places"])):
        frame = 1 + k if file.endswith(".bvh") else time * rate
        scene.frame_set(int(frame), subframe=frame - int(frame))
        for name, place in zip(track["joints"], places):
            head = armature.matrix_world @ armature.pose.bones[name].head
            away = apart(head, place)
            if away > largest:
                largest, where = away, f"{name} at {time} s"
        if track["mesh"]:
            vertices = skin(track["mesh"])
            assert len(vertices) == len(track["vertices"][k]), len(vertices)
            for v, (vertex, place) in enumerate(zip(vertices, track["vertices"][k])):
                away = apart(vertex, place)
                if away > largest:
                    largest, where = away, f"vertex {v} at {time} s"
    found.append({"frames": len(track["times"]), "largest_m": largest, "where": where})
json.dump(found, open(answer, "w"))
