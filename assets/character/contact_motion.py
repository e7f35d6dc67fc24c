"""A motion near key poses whose bearing points neither slide nor leave the floor, and which may be stopped at any time.

Key poses alone would slide, sink in and fall over. The clip is the motion nearest to them, and smoothest, in which what bears rolls on the floor,
the rest stays above it, and the floor force acts within what bears: as the clip moves, and as it would stand still. The floor meets what the
physics meets, the converter's colliders. Found by Gauss–Newton on spline curves.
"""
import numpy as np

import standing
from balance import floor_forces, points
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


# What the converter makes of the mesh: mass shares and where they are along the bones (as balance.py has them) …
_SIDE_BONES = [("clavicle", "upperarm", 0.0108, 0.72, 0.2), ("upperarm", "forearm", 0.0331, 0.386, 0.305), ("forearm", "hand", 0.0141, 0.43, 0.27),
               ("thigh", "shin", 0.0914, 0.502, 0.254), ("shin", "foot", 0.0477, 0.425, 0.277), ("foot", "toes", 0.0167, 0.3, 0.4)]
BONES = [("pelvis", "spine_02", 0.182, -0.064, 0.45), ("spine_01", "spine_02", 0.0815, 0.48, 0.5), ("spine_02", "chest", 0.0975, 0.525, 0.5),
         ("chest", "neck", 0.1295, 0.43, 0.43), ("neck", "head", 0.0102, 0.5, 0.3), ("head", (0, 1.75, 0), 0.0554, 0.41, 0.35)]
BONES += [(a + t, b + t, *rest) for t in SIDES for a, b, *rest in _SIDE_BONES]
BONES += [("hand" + t, (sign * 0.66, 0.93, 0), 0.0082, 0.33, 0.3) for t, sign in zip(SIDES, (1, -1))]
# … and the balls (x to the left, y up, z ahead, radius, in the bind pose, m) on which the colliders may stand.
_MIDDLE = {"loin": ("spine_01", 0, 1.120, 0.003, 0.091), "waist": ("spine_02", 0, 1.242, 0.004, 0.099), "head": ("head", 0, 1.648, 0.006, 0.084)}
_SIDE = {"seat": ("pelvis", 0.049, 0.945, -0.027, 0.116), "back": ("chest", 0.077, 1.392, 0.001, 0.086), "shoulder": ("clavicle", 0.137, 1.458, -0.019, 0.043),
         "upperarm": ("upperarm", 0.333, 1.262, -0.010, 0.043), "elbow": ("forearm", 0.411, 1.191, -0.012, 0.034), "palm": ("hand", 0.569, 1.033, -0.011, 0.026),
         "wrist": ("forearm", 0.513, 1.089, -0.012, 0.034), "fingers": ("hand", 0.651, 0.939, 0.003, 0.026), "thigh": ("thigh", 0.115, 0.793, 0.008, 0.065),
         "thigh_low": ("thigh", 0.081, 0.586, 0.004, 0.065), "knee": ("shin", 0.088, 0.437, -0.010, 0.045), "shin_low": ("shin", 0.088, 0.145, -0.010, 0.045),
         "heel_in": ("foot", 0.039, 0, -0.070, 0), "heel_out": ("foot", 0.130, 0, -0.070, 0), "ball_in": ("foot", 0.039, 0, 0.129, 0), "ball_out": ("foot", 0.130, 0, 0.129, 0),
         "heel_up_in": ("foot", 0.039, 0.083, -0.070, 0), "heel_up_out": ("foot", 0.130, 0.083, -0.070, 0), "instep_out": ("foot", 0.130, 0.083, 0.129, 0),
         "toe_in": ("toes", 0.026, 0, 0.194, 0), "toe_out": ("toes", 0.117, 0, 0.211, 0), "toe_pad_in": ("toes", 0.040, 0, 0.120, 0), "toe_pad_out": ("toes", 0.132, 0, 0.131, 0),
         "toe_up_in": ("toes", 0.026, 0.044, 0.194, 0), "toe_up_out": ("toes", 0.117, 0.044, 0.211, 0)}
_BALLS = {name: (joint, np.array([x, y, z]), r) for name, (joint, x, y, z, r) in _MIDDLE.items()}
_BALLS |= {name + t: (joint if joint in AT else joint + t, np.array([sign * x, y, z]), r)
           for t, sign in zip(SIDES, (1, -1)) for name, (joint, x, y, z, r) in _SIDE.items()}
RADIUS = np.array([r for _, _, r in _BALLS.values()])
_ANGLES = np.arange(16) * np.pi / 8
DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)])


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
    """Middles of all balls [ball][frame][3], and how their bodies turn to the next frame, rotation vectors [ball][frame][3]."""
    rotation, place = m.globals()
    spin = {}
    for joint in {joint for joint, _, _ in _BALLS.values()}:
        r = rotation[joint]
        d = np.roll(r, -1, axis=0) @ np.transpose(r, (0, 2, 1))
        spin[joint] = np.stack([d[:, 2, 1] - d[:, 1, 2], d[:, 0, 2] - d[:, 2, 0], d[:, 1, 0] - d[:, 0, 1]], axis=1) / 2
    return (np.array([place[joint] + rotation[joint] @ (at - AT[joint]) for joint, at, _ in _BALLS.values()]),
            np.array([spin[joint] for joint, _, _ in _BALLS.values()]))


class ContactMotion:
    """One clip: `keys` (share of the time, field values), `bearing` (names of points, from, to)."""

    def __init__(self, seconds, keys, bearing, stands=True):
        """`stands`: ends in the first pose of `stand`."""
        self.frames = int(round(seconds * COARSE)) // SPAN * SPAN + 1
        self.spans = (self.frames - 1) // SPAN
        self.nodes = self.spans - 1
        self.stands = stands
        self.basis = _curves(np.arange(self.frames) / SPAN, self.spans)
        t = np.linspace(0, 1, self.frames)
        times = [k[0] for k in keys]
        table = np.array([[k[1].get(f, k[1].get(f[:-2], 0.0)) for f in FIELDS] for k in keys])
        self.wish = np.array([np.interp(t, times, column) for column in table.T]).T
        width = np.hanning(13) / np.hanning(13).sum()
        padded = np.pad(self.wish, ((6, 6), (0, 0)), mode="edge")
        self.wish = np.array([np.convolve(c, width, "valid") for c in padded.T]).T
        names = list(_BALLS)
        self.bears = np.zeros((len(names), self.frames), bool)
        for group, begin, end in bearing:
            for name in group:
                self.bears[names.index(name), (t >= begin - 1e-9) & (t <= end + 1e-9)] = True
        self.trust = np.where(t < 0.1, 2.0, 0.5)  # lying should look as wished: the fall ends so
        limits = np.array([RANGE.get(f, RANGE.get(f[:-2], (-1e9, 1e9))) for f in FIELDS], float)
        self.low, self.high = limits.T
        self.end_places = places(standing.pose(1))[0][:, 0]
        self.feet = [names.index(p + s) for s in SIDES for p in ("heel_in", "heel_out", "ball_in", "ball_out")]
        low = (places(posed(self.wish))[0][:, :, 1] - RADIUS[:, None]).min(axis=0)
        self.wish[:, FIELDS.index("y")] -= np.convolve(np.pad(low, 6, mode="edge"), width, "valid")
        if stands:
            self.wish[-1] = table[-1]

    def residuals(self, values):
        """Rows [variant][frame][row], each about 1 where it begins to be bad, of field values [variant][frame][field]."""
        variants = values.shape[0]
        m = posed(values.reshape(-1, len(FIELDS)))
        at, spin = (x.reshape(len(_BALLS), variants, self.frames, 3) for x in places(m))
        padded = np.pad(values, ((0, 0), (1, 1), (0, 0)), mode="edge")
        bend = (padded[:, 2:] - 2 * padded[:, 1:-1] + padded[:, :-2]) * COARSE ** 2
        return np.concatenate([
            *self._contact_rows(at, spin),
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

    def _contact_rows(self, at, spin):
        """Bearing balls on the floor, the others not below it, 3 mm; bearing balls roll and do not slide from frame to frame, 1 mm."""
        rows = lambda x: np.moveaxis(x, 0, -1)
        height = at[..., 1] - RADIUS[:, None, None]
        rolled = RADIUS[:, None, None, None] * np.stack([spin[..., 2], -spin[..., 0]], axis=-1)
        step = np.concatenate([np.diff(at[..., [0, 2]], axis=2) + rolled[:, :, :-1], np.zeros_like(at[:, :, :1, :2])], axis=2)
        both = self.bears & np.roll(self.bears, -1, axis=1)
        some = both.any(axis=1)
        slip = step[some] * both[some][:, None, :, None] / 0.001
        return rows(np.where(self.bears[:, None], height, np.minimum(height, 0)) / 0.003), rows(slip[..., 0]), rows(slip[..., 1])

    def _inside(self, where, at, margin):
        """How far points [frame][2] on the floor are not `margin` (m) inside the hull of what bears: [frame][direction] m."""
        along = np.tensordot(at[:, :, [0, 2]], DIRECTIONS, 1)  # [ball][frame][direction]
        far = np.where(self.bears[:, :, None], along, -1e9).max(axis=0)
        wide = far + np.roll(far, 8, axis=1)
        return np.maximum(where @ DIRECTIONS - far + np.minimum(margin, 0.4 * wide), 0)

    def _balance_rows(self, m, at):
        """The floor's force acts within what bears, and would if the motion stopped; it lifts, and leans less than friction holds."""
        force, where = floor_forces(m, (self.frames - 1) / COARSE, bones=BONES)
        masses, paths = points(m, BONES)
        centre = np.tensordot(masses, paths, 1)[:, [0, 2]]
        moving = np.clip(self._inside(where[:, [0, 2]], at, 0.03), 0, 0.5) * np.clip(force[:, 1:2], 0.1, 2) / 0.02
        still = self._inside(centre, at, 0.04) / 0.01
        lift = (np.minimum(force[:, 1] - 0.4, 0) + np.maximum(force[:, 1] - 1.6, 0)) / 0.1
        lean = np.maximum(np.hypot(force[:, 0], force[:, 2]) - 0.35 * np.maximum(force[:, 1], 0), 0) / 0.1
        return np.concatenate([moving, still, lift[:, None], lean[:, None]], axis=1)

    def _end_rows(self, values, at):
        """The last frame is the first of `stand`, feet within 0.5 mm."""
        rows = np.zeros((len(values), self.frames, 3 * len(self.feet) + len(FIELDS)))
        if not self.stands:
            return rows
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
        """Ends exactly in the first pose of `stand`, if it stands."""
        frames = int(round((self.frames - 1) / COARSE * RATE)) + 1
        values = _curves(np.arange(frames) / (frames - 1) * self.spans, self.spans) @ self.controls
        m, end = posed(values), standing.pose(1)
        if not self.stands:
            return m.clip(name)
        u = np.clip(1 - (frames - 1 - np.arange(frames)) / (0.2 * RATE), 0, 1)
        w = (u ** 3 * (10 - 15 * u + 6 * u ** 2))[:, None]
        for j in NAMES:
            a, b = quaternion(m.local[j]), quaternion(end.local[j])[0]
            m.local[j] = rotation_of((1 - w) * a + w * np.where((a @ b)[:, None] < 0, -b, b))
        m.root = (1 - w) * m.root + w * end.root
        return m.clip(name)
