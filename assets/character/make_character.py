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
from figure import JOINTS, mesh


class Buffer:
    """glTF accessors over one binary chunk."""

    def __init__(self):
        self.data = bytearray()
        self.views, self.accessors = [], []

    def add(self, array, kind, component, target=None, bounds=False):
        while len(self.data) % 4:
            self.data.append(0)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target:
            view["target"] = target
        self.data += np.ascontiguousarray(array).tobytes()
        accessor = {"bufferView": len(self.views), "componentType": component, "count": len(array), "type": kind}
        if bounds:
            accessor["min"] = [float(v) for v in np.atleast_1d(array.min(axis=0))]
            accessor["max"] = [float(v) for v in np.atleast_1d(array.max(axis=0))]
        self.views.append(view)
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def main():
    positions, normals, triangles, joints, weights = mesh()
    out = Buffer()
    f32, u8, u32 = 5126, 5121, 5125
    attributes = {
        "POSITION": out.add(positions.astype(np.float32), "VEC3", f32, target=34962, bounds=True),
        "NORMAL": out.add(normals.astype(np.float32), "VEC3", f32, target=34962),
        "JOINTS_0": out.add(joints.astype(np.uint8), "VEC4", u8, target=34962),
        "WEIGHTS_0": out.add(weights.astype(np.float32), "VEC4", f32, target=34962),
    }
    indices = out.add(triangles.reshape(-1).astype(np.uint32), "SCALAR", u32, target=34963)
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
    skin = {"joints": list(range(len(JOINTS))), "inverseBindMatrices": out.add(inverse, "MAT4", f32), "skeleton": 0}
    nodes.append({"name": "body", "mesh": 0, "skin": 0})
    animations = []
    for name, rate, rotations, root in all_clips():
        frames = len(root)
        times = out.add((np.arange(frames) / rate).astype(np.float32), "SCALAR", f32, bounds=True)
        samplers, channels = [], []
        for joint, values in rotations.items():
            if np.abs(values - values[0]).max() < 1e-7 and abs(values[0][3]) > 1 - 1e-9:
                continue
            samplers.append({"input": times, "output": out.add(values.astype(np.float32), "VEC4", f32), "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": names.index(joint), "path": "rotation"}})
        samplers.append({"input": times, "output": out.add(root.astype(np.float32), "VEC3", f32), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": 0, "path": "translation"}})
        animations.append({"name": name, "samplers": samplers, "channels": channels})
    document = {
        "asset": {"version": "2.0", "generator": "Sinew make_character.py"},
        "scene": 0, "scenes": [{"nodes": [0, len(JOINTS)]}], "nodes": nodes, "skins": [skin],
        "meshes": [{"name": "body", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
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
    print(f"mannequin.glb: {len(positions)} vertices, {len(triangles)} triangles, {len(animations)} clips")


if __name__ == "__main__":
    main()
