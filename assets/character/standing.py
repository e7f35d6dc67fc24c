"""Standing at ease: the weight 45 mm before the ankles, sway of the centre of mass of 4 mm fore and aft and 2.5 mm sideways, breathing."""
import numpy as np

from balance import points
from motion import ANKLE, RATE, Motion, Y, turn

SECONDS = 8  # whole sways and two breaths
FEET, SPLAY, WEIGHT = 0.088, 9, 0.045  # m off the middle, degrees, m before the ankles
ANGLES = {"lean": 1.5, "flexion": 1.0, "neck": -2.5, "shoulder": 1.0, "abduction": 7.0, "elbow": 14.0, "wrist": -6.0}


def pose(frames, sway=0.0, aside=0.0, breath=0.0):
    """`sway`, `aside`: shift of the centre of mass, m; `breath` in −1…1."""
    m = Motion(frames)
    zero = np.zeros(frames)
    a = ANGLES
    m.trunk(lean=a["lean"], spine_flexion=a["flexion"] - 0.6 * breath, neck=a["neck"] + 0.5 * breath, head_twist=200 * aside)
    m.root = np.stack([aside + zero, 0.9545 + zero, zero], axis=1)
    for tail, sign in (("_l", 1), ("_r", -1)):
        m.arm(tail, a["shoulder"] + 120 * sway, a["abduction"] + 0.7 * breath, a["elbow"] + 0.5 * breath, wrist=a["wrist"])
        m.local["clavicle" + tail] = turn(np.array([0, 0, 1.0]), sign * 0.8 * (breath + zero))
    for _ in range(3):  # the pelvis goes where the weight has to be
        for tail, sign in (("_l", 1), ("_r", -1)):
            heading = np.tile(turn(Y, sign * SPLAY), (frames, 1, 1))
            m.plant(tail, np.tile([FEET * sign, ANKLE, 0.0], (frames, 1)), heading, zero, knee_turn=1.0)
        masses, paths = points(m)
        m.root[:, 2] += WEIGHT + sway - np.tensordot(masses, paths, 1)[:, 2]
    return m


def stand():
    """The last frame is the first again."""
    t = np.linspace(0, 2 * np.pi, SECONDS * RATE + 1)
    wave = lambda *parts: sum((np.sin(k * t + start) - np.sin(start)) / k for k, start in parts)
    return pose(len(t), 0.0045 * wave((1, 0.0), (2, 1.0), (3, 2.5), (5, 4.0)), 0.0026 * wave((1, 2.0), (3, 0.3), (4, 5.0)), np.sin(2 * t)).clip("stand")
