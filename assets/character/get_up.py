"""Getting up, from key poses and the times at which parts of the body bear on the floor.

The keys alone would slide, sink in and fall over. The clip is the motion nearest to them, and smoothest, whose bearing points neither move nor
leave the floor, whose other points stay above it, and whose floor force acts between the points that bear. Found by Gauss–Newton.
"""
import numpy as np

import standing
from balance import floor_forces
from figure import ARM, field, gradient
from motion import ANKLE, AT, NAMES, RATE, Motion, quaternion, rotation_of

COARSE = 30  # frames a second while solving
SPAN = 4  # of those frames from one control point of the curves to the next
SIDES = ("_l", "_r")
LIMB = ["shoulder", "abduction", "arm_twist", "elbow", "wrist", "pronation", "hip", "adduction", "hip_turn", "knee", "ankle", "toes"]
FIELDS = ["x", "y", "z", "lean", "side", "twist", "flexion", "spine_side", "spine_twist", "neck", "head_twist"] + [f + t for t in SIDES for f in LIMB]
# Degrees that a joint may take, and that its angle may differ from the keys', per standard deviation.
RANGE = {"shoulder": (-65, 175), "abduction": (-12, 110), "arm_twist": (-75, 75), "elbow": (3, 145), "wrist": (-80, 75), "pronation": (-75, 75), "hip": (-18, 132),
         "adduction": (-45, 20), "hip_turn": (-40, 40), "knee": (3, 148), "ankle": (-50, 36), "toes": (-15, 62), "flexion": (-25, 45), "spine_twist": (-40, 40),
         "neck": (-50, 45), "spine_side": (-25, 25)}


def _surface_points():
    """Points of the skin that may meet the floor: name → (joint, place in the bind pose)."""
    seeds = {"head_back": ("head", [0, 1.67, -0.11]), "face": ("head", [0, 1.61, 0.11]), "brow": ("head", [0, 1.68, 0.09])}
    for tail, sign in zip(SIDES, (1, -1)):
        arm, palm = ARM * [sign, 1, 1], np.array([-sign, -1, 0]) * np.sqrt(0.5)
        s, e, w, h, f = (AT[j + tail] for j in ("upperarm", "forearm", "hand", "thigh", "foot"))
        side = {
            "heel": ("foot", [h[0], 0, -0.045]), "heel_back": ("foot", [h[0], 0.03, -0.07]), "ball_in": ("foot", [h[0] - 0.03 * sign, 0, 0.12]), "ball_out": ("foot", [h[0] + 0.03 * sign, 0, 0.12]),
            "toe": ("toes", [h[0] - 0.01 * sign, 0.004, 0.185]), "instep": ("foot", [h[0], 0.06, 0.07]), "toe_top": ("toes", [h[0], 0.03, 0.17]),
            "ankle_out": ("foot", [h[0] + 0.04 * sign, 0.06, 0]), "knee": ("shin", [h[0], 0.475, 0.065]), "shin": ("shin", [h[0], 0.33, 0.045]), "calf": ("shin", [h[0], 0.36, -0.075]),
            "thigh_front": ("thigh", [h[0], 0.70, 0.09]), "thigh_back": ("thigh", [h[0], 0.72, -0.09]), "thigh_out": ("thigh", [h[0] + 0.09 * sign, 0.80, 0]),
            "hip_front": ("pelvis", [0.09 * sign, 0.965, 0.10]), "hip_out": ("pelvis", [0.17 * sign, 0.94, 0]), "seat": ("pelvis", [0.076 * sign, 0.915, -0.14]),
            "waist_back": ("spine_01", [0.08 * sign, 1.10, -0.10]), "back": ("chest", [0.09 * sign, 1.34, -0.12]), "breast": ("chest", [0.08 * sign, 1.355, 0.11]),
            "ribs_out": ("chest", [0.17 * sign, 1.33, 0]), "shoulder_back": ("clavicle", [0.15 * sign, 1.43, -0.07]), "shoulder_front": ("upperarm", s + [0, 0, 0.06]),
            "shoulder_out": ("upperarm", s + 0.05 * arm - 0.055 * palm), "elbow": ("forearm", e - [0, 0, 0.04]), "elbow_out": ("forearm", e - 0.04 * palm),
            "forearm": ("forearm", e + 0.13 * arm + 0.04 * palm), "forearm_edge": ("forearm", e + 0.13 * arm - [0, 0, 0.04]), "wrist": ("hand", w - 0.02 * palm),
            "palm": ("hand", w + 0.025 * arm + 0.017 * palm), "knuckles": ("hand", w + 0.085 * arm + 0.02 * palm), "fingers": ("hand", w + 0.16 * arm + 0.035 * palm),
            "hand_edge": ("hand", w + 0.06 * arm - [0, 0, 0.04]), "hand_back": ("hand", w + 0.08 * arm - 0.015 * palm),
        }
        seeds |= {name + tail: (joint + ("" if joint in AT else tail), at) for name, (joint, at) in side.items()}
    places = np.array([at for _, at in seeds.values()], float)
    for _ in range(4):
        places -= field(places)[:, None] * gradient(places)
    places[:, 1] = np.maximum(places[:, 1], 0)
    return {name: (joint, place) for (name, (joint, _)), place in zip(seeds.items(), places)}


POINTS = _surface_points()


def _curves(x, spans):
    """Uniform cubic B-splines [place][control] over `spans` unit spans, at rest at both ends, at the places `x`."""
    i = np.minimum(x.astype(int), spans - 1)
    u = (x - i)[:, None]
    weights = np.concatenate([(1 - u) ** 3, 3 * u ** 3 - 6 * u ** 2 + 4, -3 * u ** 3 + 3 * u ** 2 + 3 * u + 1, u ** 3], axis=1) / 6
    full = np.zeros((len(x), spans + 3))
    for k in range(4):
        full[np.arange(len(x)), i + k] += weights[:, k]
    out = full[:, 2:-2].copy()  # three equal controls at either end
    out[:, 0] += full[:, 0] + full[:, 1]
    out[:, -1] += full[:, -1] + full[:, -2]
    return out


def posed(values):
    """Motion of field values [frame][field]."""
    a = dict(zip(FIELDS, values.T))
    m = Motion(len(values))
    m.root = np.stack([a["x"], a["y"], a["z"]], axis=1)
    m.trunk(a["lean"], a["side"], a["twist"], a["flexion"], a["spine_side"], a["spine_twist"], a["neck"], a["head_twist"])
    for t in SIDES:
        m.arm(t, a["shoulder" + t], a["abduction" + t], a["elbow" + t], a["wrist" + t], a["arm_twist" + t], a["pronation" + t])
        m.leg(t, a["hip" + t], a["knee" + t], a["ankle" + t], a["adduction" + t], a["hip_turn" + t], a["toes" + t])
    return m


def places(m):
    """Of all POINTS [point][frame][3]."""
    rotation, place = m.globals()
    return np.array([place[joint] + rotation[joint] @ (at - AT[joint]) for joint, at in POINTS.values()])


class Solve:
    def __init__(self, seconds, keys, bearing):
        self.seconds = seconds
        self.frames = int(round(seconds * COARSE)) // SPAN * SPAN + 1
        self.spans = (self.frames - 1) // SPAN
        self.nodes = self.spans - 1
        self.basis = _curves(np.arange(self.frames) / SPAN, self.spans)
        t = np.linspace(0, 1, self.frames)
        times = [k[0] for k in keys]
        table = np.array([[k[1].get(f, k[1].get(f[:-2], 0.0)) for f in FIELDS] for k in keys])
        self.wish = np.array([np.interp(t, times, column) for column in table.T]).T
        width = np.hanning(13) / np.hanning(13).sum()
        padded = np.pad(self.wish, ((6, 6), (0, 0)), mode="edge")
        self.wish = np.array([np.convolve(c, width, "valid") for c in padded.T]).T
        names = list(POINTS)
        self.bears = np.zeros((len(names), self.frames), bool)
        for group, begin, end in bearing:
            for name in group:
                self.bears[names.index(name), (t >= begin - 1e-9) & (t <= end + 1e-9)] = True
        self.trust = np.where(t < 0.1, 2.0, 0.5)  # lying should look as wished: the fall ends so
        limits = np.array([RANGE.get(f, RANGE.get(f[:-2], (-1e9, 1e9))) for f in FIELDS], float)
        self.low, self.high = limits.T
        end = standing.pose(1)
        self.end_places = places(end)[:, 0]
        self.feet = [names.index(p + s) for s in SIDES for p in ("heel", "ball_in", "ball_out")]
        low = places(posed(self.wish))[:, :, 1].min(axis=0)
        self.wish[:, FIELDS.index("y")] -= np.convolve(np.pad(low, 6, mode="edge"), width, "valid")
        self.wish[-1] = table[-1]

    def residuals(self, values):
        """Rows [frame][row] of field values [frame][field]; several variants at once are [variant][frame][…]."""
        variants = values.shape[0]
        m = posed(values.reshape(-1, len(FIELDS)))
        at = places(m).reshape(len(POINTS), variants, self.frames, 3)
        rows = []
        per = lambda x, n: np.moveaxis(x, 0, -1).reshape(variants, self.frames, n)
        height = at[..., 1]
        rows.append(per(np.where(self.bears[:, None], height / 0.003, np.minimum(height, 0) / 0.003), len(POINTS)))
        step = np.concatenate([np.diff(at[..., [0, 2]], axis=2), np.zeros_like(at[:, :, :1, :2])], axis=2)
        both = self.bears & np.roll(self.bears, -1, axis=1)
        some = both.any(axis=1)
        for k in (0, 1):
            rows.append(per(step[some][..., k] * both[some][:, None] / 0.001, int(some.sum())))
        spread = np.where(np.arange(len(FIELDS)) < 3, 0.25, 18.0)
        rows.append((values - self.wish) / spread * self.trust[:, None])
        rows.append((np.minimum(values - self.low, 0) + np.maximum(values - self.high, 0)) / 2)
        bend = np.zeros_like(values)
        padded = np.pad(values, ((0, 0), (1, 1), (0, 0)), mode="edge")
        bend = (padded[:, 2:] - 2 * padded[:, 1:-1] + padded[:, :-2]) * COARSE ** 2
        rows.append(bend / np.where(np.arange(len(FIELDS)) < 3, 3.0, 900.0))
        # The floor's force acts between the points that bear, and does not pull.
        balance = np.zeros((variants, self.frames, 4))
        for v in range(variants):
            part = Motion(self.frames)
            part.local = {j: r.reshape(variants, self.frames, 3, 3)[v] for j, r in m.local.items()}
            part.root = m.root.reshape(variants, self.frames, 3)[v]
            force, where = floor_forces(part, (self.frames - 1) / COARSE)
            for k, axis in enumerate((0, 2)):
                low = np.where(self.bears, at[:, v, :, axis], 1e9).min(axis=0) + 0.01
                high = np.where(self.bears, at[:, v, :, axis], -1e9).max(axis=0) - 0.01
                middle = (low + high) / 2
                low, high = np.minimum(low, middle), np.maximum(high, middle)
                off = np.minimum(where[:, axis] - low, 0) + np.maximum(where[:, axis] - high, 0)
                balance[v, :, k] = np.clip(off, -0.5, 0.5) * np.clip(force[:, 1], 0.1, 2) / 0.02
            balance[v, :, 2] = np.minimum(force[:, 1] - 0.4, 0) / 0.1 + np.maximum(force[:, 1] - 1.6, 0) / 0.1
            level = np.hypot(force[:, 0], force[:, 2])
            balance[v, :, 3] = np.maximum(level - 0.35 * np.maximum(force[:, 1], 0), 0) / 0.1
        rows.append(balance)
        end = np.zeros((variants, self.frames, 3 * len(self.feet) + len(FIELDS)))
        foot = at[self.feet, :, -1] - self.end_places[self.feet][:, None]
        end[:, -1, :3 * len(self.feet)] = np.moveaxis(foot, 0, 1).reshape(variants, -1) / 0.0005
        end[:, -1, 3 * len(self.feet):] = (values[:, -1] - self.wish[-1]) / np.where(np.arange(len(FIELDS)) < 3, 0.002, 1.0) * self.pinned
        rows.append(end)
        return np.concatenate(rows, axis=2)

    pinned = np.array([not f.startswith(("hip", "knee", "ankle", "adduction", "toes")) for f in FIELDS], float)

    def run(self, rounds=60, log=None):
        controls = np.linalg.lstsq(self.basis, self.wish, rcond=None)[0]
        value = lambda c: self.residuals((self.basis @ c)[None])[0]
        now, damping = value(controls), 1e-2
        cost = np.sum(now ** 2)
        colours = 5
        owner = []  # of each frame: the one control of a colour that moves it
        for c in range(colours):
            node = np.round((np.arange(self.frames) / SPAN - 1 - c) / colours).astype(int) * colours + c
            node = np.where(node < 0, c, node)
            owner.append(np.where(node >= self.nodes, node - colours, node))
        for k in range(rounds):
            jacobian = np.zeros((now.size // self.frames, self.frames, self.nodes, len(FIELDS)))
            for f in range(len(FIELDS)):
                h = 1e-4 if f < 3 else 1e-2
                variants = np.repeat((self.basis @ controls)[None], colours, axis=0)
                for c in range(colours):
                    variants[c, :, f] += h * self.basis[:, c::colours].sum(axis=1)
                slope = (self.residuals(variants) - now[None]) / h
                for c in range(colours):
                    jacobian[:, np.arange(self.frames), owner[c], f] = slope[c].T
            j = jacobian.reshape(-1, self.nodes * len(FIELDS))
            gram, rhs = j.T @ j, -j.T @ now.T.reshape(-1)
            for _ in range(12):
                step = np.linalg.solve(gram + damping * np.diag(np.diag(gram) + 1e-6), rhs).reshape(self.nodes, len(FIELDS))
                trial = value(controls + step)
                if np.sum(trial ** 2) < cost:
                    break
                damping *= 5
            else:
                break
            controls, now = controls + step, trial
            gain, cost = 1 - np.sum(now ** 2) / cost, np.sum(now ** 2)
            damping = max(1e-6, damping / 5)
            if log:
                log(k, cost, damping)
            if gain < 2e-4:
                break
        self.controls = controls
        return controls

    def clip(self, name):
        """Ends exactly in the first pose of `stand`."""
        frames = int(round((self.frames - 1) / COARSE * RATE)) + 1
        values = _curves(np.arange(frames) / (frames - 1) * self.spans, self.spans) @ self.controls
        m, end = posed(values), standing.pose(1)
        u = np.clip(1 - (frames - 1 - np.arange(frames)) / (0.5 * RATE), 0, 1)
        w = (u ** 3 * (10 - 15 * u + 6 * u ** 2))[:, None]
        for j in NAMES:
            a, b = quaternion(m.local[j]), quaternion(end.local[j])[0]
            m.local[j] = rotation_of((1 - w) * a + w * np.where((a @ b)[:, None] < 0, -b, b))
        m.root = (1 - w) * m.root + w * end.root
        return m.clip(name)


def _standing_fields():
    m = standing.pose(1)
    fields = dict(zip("xyz", m.root[0])) | standing.ANGLES
    for t, sign in zip(SIDES, (1, -1)):
        r = m.local["thigh" + t][0]
        fields |= {"hip" + t: -np.degrees(np.arcsin(r[2, 1])), "adduction" + t: -sign * np.degrees(np.arctan2(-r[0, 1], r[1, 1])),
                   "hip_turn" + t: sign * np.degrees(np.arctan2(-r[2, 0], r[2, 2])), "knee" + t: np.degrees(np.arccos(m.local["shin" + t][0][1, 1]))}
        fields["ankle" + t] = fields["knee" + t] - fields["hip" + t] - fields["lean"]
    return fields


def _both(*names):
    return [n + t for n in names for t in SIDES]


SUPINE = [
    (0.00, dict(z=-0.52, lean=-90, neck=4, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=6, hip=3, ankle=-28)),
    (0.06, dict(z=-0.52, lean=-90, neck=6, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=6, hip=3, ankle=-28)),
    (0.15, dict(z=-0.52, lean=-80, flexion=22, neck=32, abduction=20, elbow=20, elbow_r=65, shoulder_r=-30, abduction_r=35, shoulder_l=20, knee=30, hip=22, ankle=-20)),
    (0.30, dict(z=-0.50, lean=-42, flexion=30, neck=18, spine_twist=-18, hip_l=85, knee_l=95, hip_r=75, knee_r=85, shoulder_l=55, elbow_l=30, abduction_l=12,
                shoulder_r=-45, abduction_r=30, elbow_r=10, wrist_r=65, arm_twist_r=-30)),
    (0.46, dict(z=-0.30, lean=18, flexion=30, neck=-5, spine_twist=-20, twist=-10, hip_l=118, knee_l=125, ankle_l=25, hip_r=108, knee_r=125, ankle_r=24, shoulder_l=60, elbow_l=30,
                shoulder_r=-5, abduction_r=45, elbow_r=10, wrist_r=60)),
    (0.64, dict(z=-0.17, lean=42, flexion=25, neck=-25, hip=128, knee=126, ankle=32, shoulder=68, elbow=22, abduction=10)),
    (0.82, dict(z=-0.07, lean=35, flexion=10, neck=-22, hip=82, knee=74, ankle=23, shoulder=35, elbow=26, abduction=9)),
    (0.92, dict(z=-0.02, lean=18, flexion=4, neck=-12, hip=40, knee=36, ankle=13, shoulder=12, elbow=20, abduction=8)),
]
SUPINE_BEARS = [
    (_both("back"), 0, 0.19), (["head_back"], 0, 0.08), (_both("seat"), 0, 0.38), (_both("heel_back"), 0, 0.04),
    (["elbow_r"], 0.15, 0.23), (["palm_r", "fingers_r"], 0.24, 0.55), (["heel_l", "ball_in_l", "ball_out_l"], 0.26, 1), (["heel_r", "ball_in_r", "ball_out_r"], 0.36, 1)]
PRONE = [
    (0.00, dict(z=0.0, lean=90, neck=-12, head_twist=55, shoulder=10, abduction=55, elbow=80, arm_twist=-60, hip=0, knee=3, ankle=-45)),
    (0.13, dict(z=0.0, lean=88, flexion=-8, neck=-25, shoulder=-20, abduction=42, elbow=120, wrist=60, pronation=40, hip=4, knee=8, ankle=-15, toes=30)),
    (0.30, dict(z=-0.20, lean=70, flexion=0, neck=-28, shoulder=60, abduction=16, elbow=45, wrist=65, pronation=40, hip=50, knee=75, ankle=0, toes=45)),
    (0.43, dict(z=-0.33, lean=72, flexion=12, neck=-28, shoulder=80, abduction=10, elbow=15, wrist=70, pronation=40, hip=85, knee=92, ankle=5, toes=50)),
    (0.58, dict(z=-0.22, lean=30, flexion=14, neck=-14, hip_l=112, knee_l=100, ankle_l=15, hip_r=30, knee_r=96, ankle_r=5, toes_r=50, shoulder=35, elbow=35, abduction=12)),
    (0.76, dict(z=-0.10, lean=32, flexion=8, neck=-16, hip_l=85, knee_l=72, ankle_l=23, hip_r=40, knee_r=58, ankle_r=10, toes_r=40, shoulder=22, elbow=28, abduction=10)),
    (0.88, dict(z=-0.02, lean=16, flexion=3, neck=-8, hip_l=35, knee_l=28, ankle_l=10, hip_r=40, knee_r=55, ankle_r=-5, shoulder=8, elbow=18, abduction=8)),
]
PRONE_BEARS = [
    (_both("breast"), 0, 0.15), (_both("hip_front"), 0, 0.16), (_both("thigh_front"), 0, 0.14), (["knee_l"], 0.11, 0.40), (["knee_r"], 0.11, 0.62), (["toe_l"], 0.15, 0.40), (["toe_r"], 0.15, 0.79),
    (_both("toe_top"), 0, 0.03), (_both("palm", "fingers"), 0.13, 0.46), (["heel_l", "ball_in_l", "ball_out_l"], 0.55, 1), (["heel_r", "ball_in_r", "ball_out_r"], 0.94, 1)]


def clips():
    end = (1.0, _standing_fields())
    for name, seconds, keys, bearing in (("get_up_supine", 3.0, SUPINE, SUPINE_BEARS), ("get_up_prone", 2.8, PRONE, PRONE_BEARS)):
        solve = Solve(seconds, keys + [end], bearing)
        solve.run()
        yield solve.clip(name)
