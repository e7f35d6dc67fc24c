#!/usr/bin/env python3
"""Makes mannequin.glb: Sinew's own demo character, skinned mesh and clips. Needs Python 3 and numpy.

glTF axes: Y up, facing +Z, left is +X; metres; every joint's axes are the world's in the bind pose (arms 45 degrees down).
Run in this directory (a minute); the same numpy on the same kind of processor writes the same bytes.
"""
import json
import os
import struct

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # sums in the same order

import numpy as np

from clips import all_clips
from details import drawn_mesh
from figure import JOINTS, body_mesh


F32, U8, U16 = 5126, 5121, 5123


class Buffer:
    """glTF accessors over one binary chunk."""

    def __init__(self):
        self.data = bytearray()
        self.views, self.accessors = [], []

    def add(self, array, kind, component, target=None, bounds=False, normalized=False):
        while len(self.data) % 4:
            self.data.append(0)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target:
            view["target"] = target
        self.data += np.ascontiguousarray(array).tobytes()
        accessor = {"bufferView": len(self.views), "componentType": component, "count": len(array), "type": kind}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor["min"] = [float(v) for v in np.atleast_1d(array.min(axis=0))]
            accessor["max"] = [float(v) for v in np.atleast_1d(array.max(axis=0))]
        self.views.append(view)
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def primitive(out, positions, normals, triangles, joints, weights, drawn=True):
    """A body that nobody sees needs neither normals nor a material, but its weights to the bit: masses come from it."""
    attributes = {"POSITION": out.add(positions.astype(np.float32), "VEC3", F32, target=34962, bounds=True)}
    if drawn:
        attributes["NORMAL"] = out.add(normals.astype(np.float32), "VEC3", F32, target=34962)
    attributes["JOINTS_0"] = out.add(joints.astype(np.uint8), "VEC4", U8, target=34962)
    if drawn:
        attributes["WEIGHTS_0"] = out.add(bytes_of_weights(weights), "VEC4", U8, target=34962, normalized=True)
    else:
        attributes["WEIGHTS_0"] = out.add(weights.astype(np.float32), "VEC4", F32, target=34962)
    made = {"attributes": attributes, "indices": out.add(triangles.reshape(-1).astype(np.uint16), "SCALAR", U16, target=34963)}
    return made | {"material": 0} if drawn else made


def bytes_of_weights(weights):
    """In 255ths, the largest taking what is left: they add up."""
    rounded = np.round(255 * weights).astype(int)
    rounded[:, 0] += 255 - rounded.sum(axis=1)
    return rounded.astype(np.uint8)


def main():
    out = Buffer()
    drawn, body = drawn_mesh(), body_mesh()
    drawn_primitive = primitive(out, *drawn)
    body_primitive = primitive(out, *body, drawn=False)
    names = [j[0] for j in JOINTS]
    inverse = np.zeros((len(JOINTS), 16), np.float32)
    nodes = []
    for i, (name, parent, at) in enumerate(JOINTS):
        base = np.array(JOINTS[names.index(parent)][2]) if parent else np.zeros(3)
        node = {"name": name, "translation": [round(float(v), 6) for v in np.array(at) - base]}
        children = [k for k, j in enumerate(JOINTS) if j[1] == name]
        if children:
            node["children"] = children
        nodes.append(node)
        matrix = np.eye(4)
        matrix[:3, 3] = -np.array(at)
        inverse[i] = matrix.T.reshape(-1)
    skin = {"joints": list(range(len(JOINTS))), "inverseBindMatrices": out.add(inverse, "MAT4", F32), "skeleton": 0}
    nodes += [{"name": "body", "mesh": 0, "skin": 0}, {"name": "UCX_body", "mesh": 1, "skin": 0}]
    animations = []
    for name, rate, rotations, root in all_clips():
        frames = len(root)
        times = out.add((np.arange(frames) / rate).astype(np.float32), "SCALAR", F32, bounds=True)
        samplers, channels = [], []
        for joint, values in rotations.items():
            if np.abs(values - values[0]).max() < 1e-7 and abs(values[0][3]) > 1 - 1e-9:
                continue
            samplers.append({"input": times, "output": out.add(values.astype(np.float32), "VEC4", F32), "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": names.index(joint), "path": "rotation"}})
        samplers.append({"input": times, "output": out.add(root.astype(np.float32), "VEC3", F32), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": 0, "path": "translation"}})
        animations.append({"name": name, "samplers": samplers, "channels": channels})
    document = {
        "asset": {"version": "2.0", "generator": "Sinew make_character.py"},
        "scene": 0, "scenes": [{"nodes": [0, len(JOINTS), len(JOINTS) + 1]}], "nodes": nodes, "skins": [skin],
        "meshes": [{"name": "body", "primitives": [drawn_primitive]}, {"name": "UCX_body", "primitives": [body_primitive]}],
        "materials": [{"name": "clay", "pbrMetallicRoughness": {"baseColorFactor": [0.27, 0.235, 0.205, 1], "metallicFactor": 0, "roughnessFactor": 0.7}}],
        "animations": animations, "accessors": out.accessors, "bufferViews": out.views, "buffers": [{"byteLength": len(out.data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(out.data) + b"\0" * (-len(out.data) % 4)
    with open("mannequin.glb", "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(data), b"BIN\0") + data)
    print(f"mannequin.glb: {len(drawn[0])} vertices drawn, {len(body[0])} of the body, {len(animations)} clips")


if __name__ == "__main__":
    main()
