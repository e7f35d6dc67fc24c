"""Clips of the mannequin, authored here: walking and running (gait.py), standing with sway and breathing, getting up from key poses."""
import numpy as np

import gait
import standing
from motion import ANKLE, AT, NAMES, RATE, Motion, quaternion
BALL, HEEL = 0.1277, -0.060

FIELDS = ["lean", "side", "twist", "flex", "spine_twist", "neck", "head_twist", "sh_l", "ab_l", "el_l", "wr_l", "sh_r", "ab_r", "el_r", "wr_r",
          "hip_l", "kn_l", "an_l", "ad_l", "ro_l", "to_l", "hip_r", "kn_r", "an_r", "ad_r", "ro_r", "to_r"]


def pose(**angles):
    both = {"sh": ("sh_l", "sh_r"), "ab": ("ab_l", "ab_r"), "el": ("el_l", "el_r"), "wr": ("wr_l", "wr_r"), "hip": ("hip_l", "hip_r"),
            "kn": ("kn_l", "kn_r"), "an": ("an_l", "an_r"), "ad": ("ad_l", "ad_r"), "ro": ("ro_l", "ro_r"), "to": ("to_l", "to_r")}
    full = dict.fromkeys(FIELDS, 0.0)
    for key, value in angles.items():
        for name in both.get(key, (key,)):
            full[name] = value
    return [full[f] for f in FIELDS]


def spline(times, values, at):
    """C2 cubic through keys, at rest at both ends."""
    t, v = np.asarray(times, float), np.asarray(values, float)
    n, h = len(t), np.diff(t)
    slope = np.diff(v) / h
    a, b = np.zeros((n, n)), np.zeros(n)
    a[0, 0], a[0, 1], b[0] = 2 * h[0], h[0], 6 * slope[0]
    a[-1, -1], a[-1, -2], b[-1] = 2 * h[-1], h[-1], -6 * slope[-1]
    for i in range(1, n - 1):
        a[i, i - 1:i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        b[i] = 6 * (slope[i] - slope[i - 1])
    m = np.linalg.solve(a, b)
    x = np.clip(at, t[0], t[-1])
    i = np.clip(np.searchsorted(t, x, side="right") - 1, 0, n - 2)
    d, hi = x - t[i], h[i]
    return v[i] + d * ((v[i + 1] - v[i]) / hi - hi * (2 * m[i] + m[i + 1]) / 6) + d ** 2 * m[i] / 2 + d ** 3 * (m[i + 1] - m[i]) / (6 * hi)


def lowest(m):
    rotation, place = m.globals()
    radius = {"pelvis": 0.115, "spine_01": 0.09, "spine_02": 0.09, "chest": 0.115, "neck": 0.06, "head": 0.085, "upperarm": 0.062,
              "forearm": 0.042, "hand": 0.03, "thigh": 0.088, "shin": 0.055, "foot": 0.045, "toes": 0.02, "clavicle": 0.05}
    low = np.full(m.frames, 1e9)
    for name in NAMES:
        low = np.minimum(low, place[name][:, 1] - radius[name.split("_")[0] if name[-2:] in ("_l", "_r") else name])
    return low


def get_up(name, seconds, keys, travel):
    """Through key poses; the lowest point of the body rests on the floor; ends in the first frame of `stand`."""
    frames = int(seconds * RATE) + 1
    t = np.arange(frames) / RATE
    times = np.array([k[0] for k in keys]) * seconds
    table = np.array([k[1] for k in keys])
    a = dict(zip(FIELDS, (spline(times, table[:, i], t) for i in range(len(FIELDS)))))
    m = Motion(frames)
    m.trunk(a["lean"], a["side"], a["twist"], a["flex"], 0, a["spine_twist"], a["neck"], a["head_twist"])
    for tail in ("_l", "_r"):
        m.arm(tail, a["sh" + tail], a["ab" + tail], a["el" + tail], a["wr" + tail])
        m.leg(tail, a["hip" + tail], a["kn" + tail], a["an" + tail], a["ad" + tail], a["ro" + tail], a["to" + tail])
    m.root = np.zeros((frames, 3))
    m.root[:, 2] = spline(times, travel, t)
    drop = lowest(m)
    window = np.hanning(19) / np.hanning(19).sum()
    height = -np.convolve(np.pad(drop, 9, mode="edge"), window, "same")[9:-9]
    m.root[:, 1] = height
    # Into the standing pose over the last third, so that the next clip begins where this one ends.
    end = standing.pose(1)
    u = np.clip((t / seconds - 0.72) / 0.28, 0, 1)
    w = u ** 3 * (10 - 15 * u + 6 * u ** 2)
    for j in NAMES:
        qa, qb = quaternion(m.local[j]), quaternion(end.local[j])[0]
        qb = np.where((qa @ qb)[:, None] < 0, -qb, qb)
        q = (1 - w[:, None]) * qa + w[:, None] * qb
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        x, y, z, r = q.T
        m.local[j] = np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * r), 2 * (x * z + y * r)], 1),
                               np.stack([2 * (x * y + z * r), 1 - 2 * (x * x + z * z), 2 * (y * z - x * r)], 1),
                               np.stack([2 * (x * z - y * r), 2 * (y * z + x * r), 1 - 2 * (x * x + y * y)], 1)], 1)
    drop = lowest(m)
    m.root[:, 1] -= np.convolve(np.pad(drop, 9, mode="edge"), window, "same")[9:-9]
    shift = end.root[0] - m.root[-1]
    m.root[:, 1] += w * shift[1]
    m.root[:, 2] -= m.root[-1, 2]
    return m.clip(name)


def all_clips():
    supine = get_up("get_up_supine", 3.0, [
        (0.00, pose(lean=-90, kn=8, hip=4, ab=22, el=10, an=-25)),
        (0.14, pose(lean=-82, flex=30, neck=30, kn=30, hip=28, ab=25, el=25, el_r=60, sh_r=-20, an=-20)),
        (0.32, pose(lean=-35, flex=30, neck=12, spine_twist=-15, hip_l=85, kn_l=105, hip_r=75, kn_r=80, sh_l=40, el_l=30, sh_r=-45, ab_r=30, el_r=12, wr_r=-50, an=5)),
        (0.50, pose(lean=25, flex=30, neck=-10, spine_twist=-12, hip_l=118, kn_l=125, an_l=22, hip_r=105, kn_r=128, an_r=25, sh_l=55, el_l=30, sh_r=10, ab_r=45, el_r=10, wr_r=-40)),
        (0.66, pose(lean=42, flex=22, neck=-28, hip=112, kn=126, an=32, sh=62, el=22, ab=12)),
        (0.84, pose(lean=33, flex=9, neck=-22, hip=76, kn=72, an=22, sh=36, el=25, ab=9)),
        (0.93, pose(lean=18, flex=4, neck=-12, hip=42, kn=36, an=13, sh=14, el=20, ab=8)),
        (1.00, pose(lean=1, flex=1.5, neck=-2, hip=3, kn=5, an=3, sh=2, el=14, ab=8))], [0.0, 0.0, 0.12, 0.42, 0.52, 0.55, 0.57, 0.58])
    prone = get_up("get_up_prone", 2.8, [
        (0.00, pose(lean=90, ab=55, el=70, sh=0, an=-40, head_twist=40, neck=-5)),
        (0.14, pose(lean=88, flex=-10, neck=-22, sh=-18, ab=40, el=120, wr=-50, an=-30)),
        (0.30, pose(lean=62, flex=2, neck=-25, sh=62, ab=15, el=45, wr=-60, hip=48, kn=78, an=-30, to=40)),
        (0.44, pose(lean=78, flex=8, neck=-28, sh=84, ab=10, el=12, wr=-70, hip=84, kn=90, an=-20, to=50)),
        (0.60, pose(lean=26, flex=12, neck=-12, sh=35, el=30, ab=12, hip_l=105, kn_l=98, an_l=12, hip_r=12, kn_r=92, an_r=-12, to_r=50)),
        (0.79, pose(lean=30, flex=8, neck=-14, sh=22, el=25, ab=10, hip_l=76, kn_l=64, an_l=20, hip_r=24, kn_r=50, an_r=-4, to_r=30)),
        (0.92, pose(lean=12, flex=3, neck=-6, sh=8, el=18, ab=8, hip_l=24, kn_l=18, an_l=8, hip_r=24, kn_r=36, an_r=6)),
        (1.00, pose(lean=1, flex=1.5, neck=-2, hip=3, kn=5, an=3, sh=2, el=14, ab=8))], [0.0, 0.0, -0.08, -0.05, 0.12, 0.25, 0.30, 0.32])
    return [gait.walk(), gait.run(), standing.stand(), supine, prone]
