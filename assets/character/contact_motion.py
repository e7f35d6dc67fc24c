"""A motion near key poses whose bearing points neither move nor leave the floor.

Key poses alone would slide, sink in and fall over. The clip is the motion nearest to them, and smoothest, whose bearing points stand still on
the floor, whose other points stay above it, and whose floor force acts between the points that bear. Found by Gauss–Newton on spline curves.
"""
import numpy as np

import standing
from balance import floor_forces
from figure import ARM, field, gradient
from motion import AT, NAMES, RATE, Motion, quaternion, rotation_of

COARSE = 30  # frames a second while solving
SPAN = 4  # of those frames from one control point of the curves to the next
SIDES = ("_l", "_r")
LIMB = ["shoulder", "abduction", "arm_twist", "elbow", "wrist", "pronation", "hip", "adduction", "hip_turn", "knee", "ankle", "toes"]
FIELDS = ["x", "y", "z", "lean", "side", "twist", "flexion", "spine_side", "spine_twist", "neck", "head_twist"] + [f + t for t in SIDES for f in LIMB]
METRES = np.arange(len(FIELDS)) < 3
# Fields that the last pose takes from `stand`; the legs follow from where the feet stand.
PINNED = np.array([not f.startswith(("hip", "knee", "ankle", "adduction", "toes")) for f in FIELDS], float)
# Degrees that a joint may take.
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
            "toe": ("toes", [h[0] - 0.01 * sign, 0.004, 0.185]), "toe_pad_in": ("toes", [h[0] - 0.03 * sign, 0, 0.152]),
            "toe_pad_out": ("toes", [h[0] + 0.03 * sign, 0, 0.148]), "instep": ("foot", [h[0], 0.06, 0.07]), "toe_top": ("toes", [h[0], 0.03, 0.17]),
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
    points = {name: (joint, place) for (name, (joint, _)), place in zip(seeds.items(), places)}
    # Corners of the boxes that the converter puts around feet and toes: a little outside the skin.
    for tail, sign in zip(SIDES, (1, -1)):
        for k, (joint, x, y, z) in enumerate((("foot", 0.04, 0, -0.066), ("foot", -0.04, 0, -0.066), ("toes", 0.04, 0, 0.203), ("toes", -0.05, 0, 0.203),
                                              ("toes", 0.04, 0.034, 0.203), ("toes", -0.05, 0.034, 0.203))):
            points[f"corner_{k}{tail}"] = (joint + tail, np.array([AT["foot" + tail][0] + sign * x, y, z]))
    return points


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


class ContactMotion:
    """One clip: `keys` (share of the time, field values), `bearing` (names of points, from, to)."""

    def __init__(self, seconds, keys, bearing):
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
        self.lift = np.zeros((len(names), 1))  # m that a point bears above the floor: colliders are thicker than the skin of seat and heel
        for group, begin, end in bearing:
            for name in group:
                self.lift[names.index(name)] = 0.007 if name.startswith(("seat", "heel_back")) else 0.0
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
        """Rows [variant][frame][row], each about 1 where it begins to be bad, of field values [variant][frame][field]."""
        variants = values.shape[0]
        m = posed(values.reshape(-1, len(FIELDS)))
        at = places(m).reshape(len(POINTS), variants, self.frames, 3)
        padded = np.pad(values, ((0, 0), (1, 1), (0, 0)), mode="edge")
        bend = (padded[:, 2:] - 2 * padded[:, 1:-1] + padded[:, :-2]) * COARSE ** 2
        return np.concatenate([
            *self._contact_rows(at),
            (values - self.wish) / np.where(METRES, 0.25, 18.0) * self.trust[:, None],
            (np.minimum(values - self.low, 0) + np.maximum(values - self.high, 0)) / 2,
            bend / np.where(METRES, 3.0, 900.0),
            np.array([self._balance_rows(self._variant(m, variants, v), at[:, v]) for v in range(variants)]),
            self._end_rows(values, at)], axis=2)

    def _variant(self, m, variants, v):
        part = Motion(self.frames)
        part.local = {j: r.reshape(variants, self.frames, 3, 3)[v] for j, r in m.local.items()}
        part.root = m.root.reshape(variants, self.frames, 3)[v]
        return part

    def _contact_rows(self, at):
        """Bearing points on the floor, the others not below it, 3 mm; steps of bearing points from frame to frame, 1 mm."""
        rows = lambda x: np.moveaxis(x, 0, -1)
        height = at[..., 1] - self.lift[:, None]
        step = np.concatenate([np.diff(at[..., [0, 2]], axis=2), np.zeros_like(at[:, :, :1, :2])], axis=2)
        both = self.bears & np.roll(self.bears, -1, axis=1)
        some = both.any(axis=1)
        slip = step[some] * both[some][:, None, :, None] / 0.001
        return rows(np.where(self.bears[:, None], height, np.minimum(height, 0)) / 0.003), rows(slip[..., 0]), rows(slip[..., 1])

    def _balance_rows(self, m, at):
        """The floor's force acts 3 cm within the box around what bears, lifts, and leans less than friction holds."""
        force, where = floor_forces(m, (self.frames - 1) / COARSE)
        out = np.zeros((self.frames, 4))
        for k, axis in enumerate((0, 2)):
            low = np.where(self.bears, at[:, :, axis], 1e9).min(axis=0) + 0.03
            high = np.where(self.bears, at[:, :, axis], -1e9).max(axis=0) - 0.03
            middle = (low + high) / 2
            off = np.minimum(where[:, axis] - np.minimum(low, middle), 0) + np.maximum(where[:, axis] - np.maximum(high, middle), 0)
            out[:, k] = np.clip(off, -0.5, 0.5) * np.clip(force[:, 1], 0.1, 2) / 0.02
        out[:, 2] = (np.minimum(force[:, 1] - 0.4, 0) + np.maximum(force[:, 1] - 1.6, 0)) / 0.1
        out[:, 3] = np.maximum(np.hypot(force[:, 0], force[:, 2]) - 0.35 * np.maximum(force[:, 1], 0), 0) / 0.1
        return out

    def _end_rows(self, values, at):
        """The last frame is the first of `stand`, feet within 0.5 mm."""
        rows = np.zeros((len(values), self.frames, 3 * len(self.feet) + len(FIELDS)))
        foot = at[self.feet, :, -1] - self.end_places[self.feet][:, None]
        rows[:, -1, :3 * len(self.feet)] = np.moveaxis(foot, 0, 1).reshape(len(values), -1) / 0.0005
        rows[:, -1, 3 * len(self.feet):] = (values[:, -1] - self.wish[-1]) / np.where(METRES, 0.002, 1.0) * PINNED
        return rows

    def solve(self, rounds=60):
        """Gauss–Newton with damping."""
        controls = np.linalg.lstsq(self.basis, self.wish, rcond=None)[0]
        value = lambda c: self.residuals((self.basis @ c)[None])[0]
        now, damping = value(controls), 1e-2
        cost = np.sum(now ** 2)
        for _ in range(rounds):
            j = self._jacobian(controls, now)
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
            if gain < 2e-4:
                break
        self.controls = controls

    def _jacobian(self, controls, now):
        """[row][control of a field], by differences. A control moves the frames near it only, so every fifth is varied at once."""
        colours = 5
        out = np.zeros((now.size // self.frames, self.frames, self.nodes, len(FIELDS)))
        for f in range(len(FIELDS)):
            h = 1e-4 if METRES[f] else 1e-2
            variants = np.repeat((self.basis @ controls)[None], colours, axis=0)
            for c in range(colours):
                variants[c, :, f] += h * self.basis[:, c::colours].sum(axis=1)
            slope = (self.residuals(variants) - now[None]) / h
            for c in range(colours):
                node = np.round((np.arange(self.frames) / SPAN - 1 - c) / colours).astype(int) * colours + c
                node = np.where(node < 0, c, node)
                node = np.where(node >= self.nodes, node - colours, node)  # of each frame: the one control varied that moves it
                out[:, np.arange(self.frames), node, f] = slope[c].T
        return out.reshape(-1, self.nodes * len(FIELDS))

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
