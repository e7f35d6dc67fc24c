"""Clips of the mannequin, authored here: key curves through the published peaks of walking and running (hip, knee, ankle ranges,
stance and swing fractions, trunk and arm amplitudes), feet planted by inverse kinematics; standing with sway and breathing;
getting up from key poses. Angles in degrees: flexion, adduction inwards, trunk lean forward positive.
"""
import numpy as np

from figure import JOINTS

RATE = 60
AT = {name: np.array(p, float) for name, _, p in JOINTS}
PARENT = {name: parent for name, parent, _ in JOINTS}
NAMES = [j[0] for j in JOINTS]
THIGH, SHANK = AT["thigh_l"][1] - AT["shin_l"][1], AT["shin_l"][1] - AT["foot_l"][1]
ANKLE = AT["foot_l"][1]
BALL, HEEL = 0.1277, -0.060  # m before the ankle
X, Y, Z = np.eye(3)


def turn(axis, degrees):
    """Rotation matrices [frame][3][3] about a fixed axis."""
    a = np.radians(np.atleast_1d(np.asarray(degrees, float)))[:, None, None]
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * (k @ k)


def quaternion(m):
    """[frame] x y z w, sign-aligned."""
    w = np.sqrt(np.maximum(0, 1 + m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2])) / 2
    x = np.copysign(np.sqrt(np.maximum(0, 1 + m[:, 0, 0] - m[:, 1, 1] - m[:, 2, 2])) / 2, m[:, 2, 1] - m[:, 1, 2])
    y = np.copysign(np.sqrt(np.maximum(0, 1 - m[:, 0, 0] + m[:, 1, 1] - m[:, 2, 2])) / 2, m[:, 0, 2] - m[:, 2, 0])
    z = np.copysign(np.sqrt(np.maximum(0, 1 - m[:, 0, 0] - m[:, 1, 1] + m[:, 2, 2])) / 2, m[:, 1, 0] - m[:, 0, 1])
    q = np.stack([x, y, z, w], axis=1)
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    for i in range(1, len(q)):
        if q[i] @ q[i - 1] < 0:
            q[i] = -q[i]
    return q


def periodic(keys, phase):
    """C2 periodic cubic through (phase, value) keys."""
    t, v = np.array(sorted(keys)).T
    n = len(t)
    h = np.diff(np.append(t, t[0] + 1))
    slope = np.diff(np.append(v, v[0])) / h
    a = np.zeros((n, n))
    b = np.zeros(n)
    for i in range(n):
        a[i, i - 1] += h[i - 1]
        a[i, i] += 2 * (h[i - 1] + h[i])
        a[i, (i + 1) % n] += h[i]
        b[i] = 6 * (slope[i] - slope[i - 1])
    m = np.linalg.solve(a, b)
    return _cubic(t, v, h, m, np.append(np.arange(1, n), 0), (np.asarray(phase) - t[0]) % 1 + t[0])


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
    return _cubic(t, v, h, np.linalg.solve(a, b), np.arange(1, n), np.clip(at, t[0], t[-1]))


def _cubic(t, v, h, m, after, x):
    i = np.clip(np.searchsorted(t, x, side="right") - 1, 0, len(h) - 1)
    j = after[i]
    d, hi = x - t[i], h[i]
    return (v[i] + d * ((v[j] - v[i]) / hi - hi * (2 * m[i] + m[j]) / 6) + d ** 2 * m[i] / 2 + d ** 3 * (m[j] - m[i]) / (6 * hi))


class Motion:
    """Local rotations of all joints and the root's path, frame by frame."""

    def __init__(self, frames):
        self.frames = frames
        self.local = {name: np.tile(np.eye(3), (frames, 1, 1)) for name in NAMES}
        self.root = np.tile(AT["pelvis"], (frames, 1))

    def trunk(self, lean=0, side=0, twist=0, spine_flexion=0, spine_side=0, spine_twist=0, neck=0, head_twist=0):
        """Pelvis lean (about left), tilt (about forward) and turn (about up); the spine shares the rest between three joints."""
        self.local["pelvis"] = turn(Y, twist + np.zeros(self.frames)) @ turn(Z, side + np.zeros(self.frames)) @ turn(X, lean + np.zeros(self.frames))
        for name, share in (("spine_01", 0.3), ("spine_02", 0.35), ("chest", 0.35)):
            self.local[name] = (turn(Y, share * (spine_twist + np.zeros(self.frames))) @ turn(Z, share * (spine_side + np.zeros(self.frames)))
                                @ turn(X, share * (spine_flexion + np.zeros(self.frames))))
        for name in ("neck", "head"):
            self.local[name] = turn(Y, 0.5 * (head_twist + np.zeros(self.frames))) @ turn(X, 0.5 * (neck + np.zeros(self.frames)))

    def arm(self, tail, flexion, abduction, elbow, wrist=0, twist=0):
        sign = 1 if tail == "_l" else -1
        zero = np.zeros(self.frames)
        hang = turn(Z, sign * (abduction - 45 + zero))
        self.local["upperarm" + tail] = turn(X, -(flexion + zero)) @ hang @ turn(AT["forearm" + tail] / np.linalg.norm(AT["forearm" + tail]), zero + twist)
        axis = turn(Z, sign * 45.0)[0] @ X  # the elbow's axis points left when the arm hangs
        self.local["forearm" + tail] = turn(axis, -(elbow + zero))
        self.local["hand" + tail] = turn(axis, -(wrist + zero))

    def leg(self, tail, hip, knee, ankle=0, adduction=0, rotation=0, toes=0):
        sign = 1 if tail == "_l" else -1
        zero = np.zeros(self.frames)
        self.local["thigh" + tail] = turn(Z, -sign * (adduction + zero)) @ turn(X, -(hip + zero)) @ turn(Y, sign * (rotation + zero))
        self.local["shin" + tail] = turn(X, knee + zero)
        self.local["foot" + tail] = turn(X, -(ankle + zero))
        self.local["toes" + tail] = turn(X, -(toes + zero))

    def globals(self):
        rotation, place = {}, {}
        for name in NAMES:
            parent = PARENT[name]
            if parent is None:
                rotation[name], place[name] = self.local[name], self.root
            else:
                rotation[name] = rotation[parent] @ self.local[name]
                place[name] = place[parent] + rotation[parent] @ (AT[name] - AT[parent])
        return rotation, place

    def plant(self, tail, ankle, pitch, toe_bend, splay=5.0):
        """Leg by inverse kinematics: ankle path [frame][3] (m), foot pitch (toes up positive), toes kept level by toe_bend."""
        sign = 1 if tail == "_l" else -1
        rotation, place = self.globals()
        hip, up = place["thigh" + tail], rotation["pelvis"]
        foot = turn(Y, sign * splay + np.zeros(self.frames)) @ turn(X, -(pitch + np.zeros(self.frames)))
        reach = ankle - hip
        length = np.linalg.norm(reach, axis=1)
        far = 0.9985 * (THIGH + SHANK)
        length = np.where(length > far - 0.02, far - 0.02 * np.exp(-(length - far + 0.02) / 0.02), length)  # never quite straight
        bend = np.arccos(np.clip((THIGH ** 2 + SHANK ** 2 - length ** 2) / (2 * THIGH * SHANK), -1, 1))
        inner = np.arccos(np.clip((THIGH ** 2 + length ** 2 - SHANK ** 2) / (2 * THIGH * length), -1, 1))
        down = reach / np.linalg.norm(reach, axis=1, keepdims=True)
        forward = foot @ Z
        forward[:, 1] = 0
        left = np.cross(Y, forward / np.linalg.norm(forward, axis=1, keepdims=True))
        left -= np.sum(left * down, axis=1, keepdims=True) * down
        left /= np.linalg.norm(left, axis=1, keepdims=True)
        frame = np.stack([left, -down, np.cross(left, -down)], axis=2)
        thigh = frame @ turn(X, -np.degrees(inner))
        shin = thigh @ turn(X, np.degrees(np.pi - bend))
        self.local["thigh" + tail] = np.transpose(up, (0, 2, 1)) @ thigh
        self.local["shin" + tail] = np.transpose(thigh, (0, 2, 1)) @ shin
        self.local["foot" + tail] = np.transpose(shin, (0, 2, 1)) @ foot
        self.local["toes" + tail] = turn(X, -(toe_bend + np.zeros(self.frames)))

    def lowest(self):
        """Lowest point of the body, m above the floor: spheres on the joints, heels and toes."""
        rotation, place = self.globals()
        radius = {"pelvis": 0.115, "spine_01": 0.09, "spine_02": 0.09, "chest": 0.115, "neck": 0.06, "head": 0.085, "upperarm": 0.062,
                  "forearm": 0.042, "hand": 0.03, "thigh": 0.088, "shin": 0.055, "foot": 0.045, "toes": 0.02, "clavicle": 0.05}
        low = np.full(self.frames, 1e9)
        for name in NAMES:
            low = np.minimum(low, place[name][:, 1] - radius[name.split("_")[0] if name[-2:] in ("_l", "_r") else name])
        for tail in ("_l", "_r"):
            for point, r in ((np.array([0, -ANKLE + 0.004, HEEL]), 0.004), (np.array([0, -ANKLE + 0.02, BALL]), 0.02)):
                low = np.minimum(low, (place["foot" + tail] + rotation["foot" + tail] @ point)[:, 1] - r)
            low = np.minimum(low, (place["hand" + tail] + rotation["hand" + tail] @ (0.12 * (AT["hand" + tail] - AT["forearm" + tail]) / 0.255))[:, 1] - 0.024)
        head = place["head"] + rotation["head"] @ np.array([0, 0.075, -0.02])
        return np.minimum(low, head[:, 1] - 0.105)

    def clip(self, name, rate=RATE):
        return name, rate, {j: quaternion(self.local[j]) for j in NAMES}, self.root


def gait(name, cycle, stride, stance, keys, pelvis_height, bounce, contact_ahead, trunk_lean, arm_swing, elbow):
    """Both legs from one foot's path in phase (0: its first contact), half a cycle apart."""
    frames = int(round(cycle * RATE)) + 1
    phase = np.arange(frames) / (frames - 1)
    m = Motion(frames)
    m.root = np.stack([0.016 * np.sin(2 * np.pi * (phase + 0.18)), pelvis_height + bounce * np.cos(4 * np.pi * (phase - 0.30)), stride * phase], axis=1)
    m.trunk(lean=trunk_lean, side=-2.5 * np.sin(2 * np.pi * (phase + 0.02)), twist=-4 * np.cos(2 * np.pi * phase), spine_flexion=1.5,
            spine_side=2.2 * np.sin(2 * np.pi * (phase + 0.02)), spine_twist=9 * np.cos(2 * np.pi * (phase - 0.01)), neck=-trunk_lean - 1.5, head_twist=-5 * np.cos(2 * np.pi * phase))
    dense = np.linspace(0, 1, 1001)
    pitch = periodic(keys["pitch"], dense)

    def over_pivot(p):
        """Ankle of a foot that rolls over heel, sole and ball, relative to where the ball will stand."""
        a = np.radians(np.interp(p, dense, pitch))
        on_heel = np.interp(p, dense, pitch) > 0
        pivot = np.where(on_heel, HEEL, BALL)
        y = np.where(on_heel, 0.0, 0.012)
        along = np.cos(a) * -pivot - np.sin(a) * (ANKLE - y)
        up = -np.sin(a) * pivot + np.cos(a) * (ANKLE - y)
        return pivot - BALL + along, up + y

    start_z, start_y = over_pivot(np.array([0.0]))
    ball_at = contact_ahead - start_z[0]
    p_stance = dense[dense <= stance]
    z, y = over_pivot(p_stance)
    # Swing: from toe-off to the next contact, positions and speeds matched by a quintic, lifted in between.
    p_swing = dense[dense > stance]
    u = (p_swing - stance) / (1 - stance)
    ds = 0.004
    (z0b, z0), (y0b, y0) = over_pivot(np.array([stance - ds, stance]))
    (z1, z1a), (y1, y1a) = over_pivot(np.array([0.0, ds]))
    z1, z1a = z1 + stride, z1a + stride
    span = 1 - stance
    hermite = lambda a, va, b, vb: (a + va * u + (10 * (b - a) - 6 * va - 4 * vb) * u ** 3 + (-15 * (b - a) + 8 * va + 7 * vb) * u ** 4 + (6 * (b - a) - 3 * va - 3 * vb) * u ** 5)
    swing_z = hermite(z0, (z0 - z0b) / ds * span, z1, (z1a - z1) / ds * span)
    swing_y = hermite(y0, (y0 - y0b) / ds * span, y1, (y1a - y1) / ds * span) + keys["lift"] * (u * (1 - u)) ** 3 * 64 * (1 - 0.45 * u)
    path_z, path_y = np.concatenate([z, swing_z]) + ball_at, np.concatenate([y, swing_y])
    toe = np.clip(-pitch, 0, 60) * np.clip((stance + 0.12 - dense) / 0.12, 0, 1)
    toe = np.convolve(np.concatenate([toe[-61:-1], toe, toe[1:61]]), np.hanning(61) / np.hanning(61).sum(), "same")[60:-60]
    for tail, shift, side in (("_r", 0.0, -1), ("_l", 0.5, 1)):
        own = (phase + shift) % 1.0
        laps = np.floor(phase + shift)
        ankle = np.stack([side * 0.062 + np.zeros(frames), np.interp(own, dense, path_y), np.interp(own, dense, path_z) + stride * (laps - shift)], axis=1)
        m.plant(tail, ankle, np.interp(own, dense, pitch), np.interp(own, dense, toe))
        swing = -np.cos(2 * np.pi * (own - 0.02))  # the arm goes back as its leg comes forward
        m.arm(tail, arm_swing[0] + arm_swing[1] * swing, 6 + 1.5 * np.abs(swing), elbow[0] + elbow[1] * (0.5 + 0.5 * swing), wrist=4)
    return m.clip(name)


def stand_pose(m, sway=0, breath=0, hip_shift=0.0):
    m.trunk(lean=1.0, spine_flexion=1.5 - 1.2 * breath, neck=-2.0 + 0.9 * breath, head_twist=1.5 * sway)
    m.root = np.tile([0.0, 0.947, 0.0], (m.frames, 1)) + np.stack([0.006 * sway + hip_shift, -0.001 * np.abs(sway), 0.004 * sway], axis=1) + np.zeros((m.frames, 3))
    for tail, sign in (("_l", 1), ("_r", -1)):
        m.arm(tail, 2 + 0.8 * sway, 8 + 0.8 * breath, 14 + breath, wrist=5)
        m.plant(tail, np.tile([0.088 * sign, ANKLE, 0.0], (m.frames, 1)), 0, 0, splay=8)


def stand():
    seconds = 8
    frames = seconds * RATE + 1
    t = np.linspace(0, 2 * np.pi, frames)
    m = Motion(frames)
    sway = 0.5 * np.sin(t) + 0.3 * np.sin(2 * t + 1) + 0.18 * np.sin(3 * t + 2)
    stand_pose(m, sway - sway[0], np.sin(2 * t) * 0.5)
    return m.clip("stand")


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
    drop = m.lowest()
    window = np.hanning(19) / np.hanning(19).sum()
    height = -np.convolve(np.pad(drop, 9, mode="edge"), window, "same")[9:-9]
    m.root[:, 1] = height
    # Into the standing pose over the last third, so that the next clip begins where this one ends.
    end = Motion(1)
    stand_pose(end, np.zeros(1), np.zeros(1))
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
    drop = m.lowest()
    m.root[:, 1] -= np.convolve(np.pad(drop, 9, mode="edge"), window, "same")[9:-9]
    shift = end.root[0] - m.root[-1]
    m.root[:, 1] += w * shift[1]
    m.root[:, 2] -= m.root[-1, 2]
    return m.clip(name)


def all_clips():
    walk = gait("walk", 1.07, 1.30, 0.61, {"pitch": [(0, 19), (0.035, 10), (0.09, 0), (0.2, 0), (0.32, -0.5), (0.42, -9), (0.52, -30), (0.61, -58), (0.69, -62), (0.78, -30), (0.88, 6), (0.95, 20)],
                                            "lift": 0.035}, 0.912, 0.014, 0.315, 3.0, (-4, 20), (16, 20))
    run = gait("run", 0.70, 2.15, 0.36, {"pitch": [(0, 8), (0.05, 0), (0.12, 0), (0.2, -10), (0.28, -35), (0.36, -62), (0.48, -95), (0.62, -75), (0.78, -25), (0.92, 8)],
                                          "lift": 0.20}, 0.875, 0.024, 0.22, 9.0, (-6, 32), (78, 16))
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
    return [walk, run, stand(), supine, prone]
