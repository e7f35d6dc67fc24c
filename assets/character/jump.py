#!/usr/bin/env python3
"""Makes jump.glb: a jump on the spot for the mannequin, its joints and one clip. Needs Python 3 and numpy; run in this directory.

Crouch, push, flight by the law of gravity, landing on the balls of the feet. Heights of the pelvis stand for those of the body's mass.
"""
import json
import struct

import numpy as np

import standing
from balance import GRAVITY
from figure import JOINTS
from make_character import Buffer
from motion import ANKLE, BALL, NAMES, RATE, Motion, Y, smoothest, turn

TAKE_OFF, LANDING, SECONDS = 0.55, 0.97, 1.75
STAND, RISEN = 0.9545, 0.985  # m, of the pelvis: at ease, and when the toes leave the floor


def times():
    return np.arange(int(round(SECONDS * RATE)) + 1) / RATE


def track(t, keys):
    """The smoothest way through (time, value), at rest before and after."""
    fixed = (t < 0.05) | (t > SECONDS - 0.1)
    ends = np.where(t < 1, keys[0][1], keys[-1][1])
    return smoothest(fixed, ends, [(k * RATE, v) for k, v in keys[1:-1]])


def pelvis_height(t):
    flight = (t >= TAKE_OFF) & (t <= LANDING)
    rise = GRAVITY * (LANDING - TAKE_OFF) / 2
    s = t - TAKE_OFF
    values = np.where(flight, RISEN + rise * s - GRAVITY * s ** 2 / 2, STAND)
    fixed = flight | (t < 0.05) | (t > SECONDS - 0.15)
    return smoothest(fixed, values, [(0.33 * RATE, 0.74), (1.15 * RATE, 0.80), (1.45 * RATE, 0.93)])


def feet(m, t, height):
    """Heels rise until the toes leave, hang down in flight, and come down after the balls."""
    pitch = smoothest((t < 0.30) | (t > 1.16), np.zeros(len(t)), [(k * RATE, v) for k, v in ((0.44, 10), (TAKE_OFF, 38), (0.72, 44), (0.88, 28), (LANDING, 16))])
    toes = track(t, [(0, 1), (0.45, 1), (TAKE_OFF, 0.9), (0.72, 0.35), (0.85, 0.35), (LANDING, 0.9), (1.1, 1), (SECONDS, 1)]) * pitch
    air = np.where((t > TAKE_OFF) & (t < LANDING), height - RISEN, 0)
    tuck = 0.05 * np.sin(np.pi * np.clip((t - TAKE_OFF) / (LANDING - TAKE_OFF), 0, 1)) ** 3
    a = np.radians(pitch)
    pivot, up = BALL[2], -BALL[1]
    forward = pivot - np.cos(a) * pivot + np.sin(a) * -up
    lift = ANKLE - up + np.cos(a) * up + np.sin(a) * pivot + air + tuck
    for tail, sign in (("_l", 1), ("_r", -1)):
        heading = turn(Y, sign * standing.SPLAY)
        foot = np.tile(heading, (m.frames, 1, 1)) @ turn(np.array([1.0, 0, 0]), pitch)
        way = heading[0] @ np.array([0, 0, 1.0])
        ankle = np.stack([standing.FEET * sign + forward * way[0], lift, forward * way[2]], axis=1)
        m.plant(tail, ankle, foot, toes, knee_turn=1.0)


def jump():
    t = times()
    m = Motion(len(t))
    height = pelvis_height(t)
    lean = track(t, [(0, 1.5), (0.33, 34), (TAKE_OFF, 4), (0.75, 0), (LANDING, 8), (1.17, 30), (1.45, 8), (SECONDS, 1.5)])
    flexion = track(t, [(0, 1), (0.33, 14), (TAKE_OFF, -2), (0.75, 0), (1.17, 10), (SECONDS, 1)])
    neck = track(t, [(0, -2.5), (0.33, -22), (TAKE_OFF, -4), (1.17, -18), (SECONDS, -2.5)])
    shoulder = track(t, [(0, 1), (0.30, -38), (TAKE_OFF, 75), (0.72, 95), (LANDING, 45), (1.2, 12), (SECONDS, 1)])
    elbow = track(t, [(0, 14), (0.30, 22), (TAKE_OFF, 55), (0.75, 50), (LANDING, 35), (SECONDS, 14)])
    m.trunk(lean=lean, spine_flexion=flexion, neck=neck)
    for tail in ("_l", "_r"):
        m.arm(tail, shoulder, 9, elbow, wrist=-6)
    start = standing.pose(1)
    back = track(t, [(0, 0), (0.33, -0.055), (TAKE_OFF, 0.02), (LANDING, 0.0), (1.17, -0.05), (SECONDS, 0)])
    m.root = np.stack([np.zeros(len(t)), height, start.root[0, 2] + back], axis=1)
    feet(m, t, height)
    return m.clip("jump")


def main():
    name, rate, rotations, root = jump()
    out = Buffer()
    nodes = []
    for joint, parent, at in JOINTS:
        base = np.array(JOINTS[NAMES.index(parent)][2]) if parent else np.zeros(3)
        node = {"name": joint, "translation": [round(float(v), 6) for v in np.array(at) - base]}
        children = [k for k, j in enumerate(JOINTS) if j[1] == joint]
        if children:
            node["children"] = children
        nodes.append(node)
    times_of = out.add((np.arange(len(root)) / rate).astype(np.float32), "SCALAR", 5126, bounds=True)
    samplers, channels = [], []
    for joint, values in rotations.items():
        samplers.append({"input": times_of, "output": out.add(values.astype(np.float32), "VEC4", 5126), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": NAMES.index(joint), "path": "rotation"}})
    samplers.append({"input": times_of, "output": out.add(root.astype(np.float32), "VEC3", 5126), "interpolation": "LINEAR"})
    channels.append({"sampler": len(samplers) - 1, "target": {"node": 0, "path": "translation"}})
    document = {"asset": {"version": "2.0", "generator": "Sinew jump.py"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
                "animations": [{"name": name, "samplers": samplers, "channels": channels}], "accessors": out.accessors,
                "bufferViews": out.views, "buffers": [{"byteLength": len(out.data)}]}
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(out.data) + b"\0" * (-len(out.data) % 4)
    with open("jump.glb", "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(data), b"BIN\0") + data)
    print(f"jump.glb: {len(root)} frames, up to {root[:, 1].max():.2f} m")


if __name__ == "__main__":
    main()
