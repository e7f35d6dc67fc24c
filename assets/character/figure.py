"""Skeleton and body of the mannequin: a smooth union of limbs with elliptic sections, polygonised by surface nets.

Segment lengths: thigh 0.245, shank 0.246, foot 0.152, upper arm 0.166, forearm 0.146 of a stature of 1.75 m (Drillis & Contini,
de Leva's joint centres).
"""
import numpy as np

from surface import surface_nets

ARM = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0])  # bind direction of the left arm


def _joints():
    shoulder = np.array([0.178, 1.425, -0.012])
    elbow = shoulder + 0.285 * ARM
    wrist = elbow + 0.255 * ARM
    side = {
        "clavicle": ("chest", [0.025, 1.435, 0.0]), "upperarm": ("clavicle", shoulder), "forearm": ("upperarm", elbow),
        "hand": ("forearm", wrist), "thigh": ("pelvis", [0.0875, 0.9273, 0.0]), "shin": ("thigh", [0.0875, 0.4986, 0.0]),
        "foot": ("shin", [0.0875, 0.0683, 0.0]), "toes": ("foot", [0.0875, 0.022, 0.1277]),
    }
    joints = [("pelvis", None, [0, 0.96, 0]), ("spine_01", "pelvis", [0, 1.06, -0.01]), ("spine_02", "spine_01", [0, 1.18, -0.015]),
              ("chest", "spine_02", [0, 1.30, -0.02]), ("neck", "chest", [0, 1.485, -0.02]), ("head", "neck", [0, 1.575, -0.005])]
    for tail, sign in (("_l", 1), ("_r", -1)):
        for name, (parent, at) in side.items():
            at = np.array(at, float) * [sign, 1, 1]
            joints.append((name + tail, parent if parent in ("chest", "pelvis") else parent + tail, at.tolist()))
    return joints


JOINTS = _joints()


class Loft:
    """A limb: ellipses along a straight line, their sizes smooth curves through the rows (along, half width, half depth, centre's shift across and
    in depth), its ends rounded. `side`: direction of the width, `deep`: of the depth, unit vectors across `axis`; metres."""

    def __init__(self, name, start, axis, side, deep, rows, roundness=2.0, caps=(0.03, 0.03)):
        self.name, self.start, self.roundness, self.caps = name, np.asarray(start, float), roundness, caps
        self.axis, self.side, self.deep = (np.asarray(v, float) for v in (axis, side, deep))
        rows = np.array(rows, float)
        self.first, self.last = rows[0, 0], rows[-1, 0]
        self.grid = np.linspace(self.first, self.last, 200)
        self.curves = [_smooth_curve(rows[:, 0], rows[:, k], self.grid) for k in range(1, rows.shape[1])]

    def along(self, p):
        return (p - self.start) @ self.axis

    def distance(self, p):
        """About the distance to the surface, negative inside (Quilez's estimate for ellipsoids)."""
        q = p - self.start
        s = q @ self.axis
        t = np.clip(s, self.first, self.last)
        a, b, across, depth = (np.interp(t, self.grid, c) for c in self.curves)
        u, v = q @ self.side - across, q @ self.deep - depth
        over = np.where(s < self.first, (s - self.first) / self.caps[0], np.where(s > self.last, (s - self.last) / self.caps[1], 0))
        cap = np.where(s < self.first, self.caps[0], self.caps[1])
        k = self.roundness
        near = (np.abs(u / a) ** k + np.abs(v / b) ** k) ** (1 / k)
        k0 = np.hypot(near, over)
        slope = np.sqrt((u / a ** 2) ** 2 + (v / b ** 2) ** 2 + (over / cap) ** 2)
        return k0 * (k0 - 1) / np.maximum(slope, 1e-6) * np.where(slope > 1e-6, 1, 0) - np.where(slope > 1e-6, 0, np.minimum(a, b))


def _smooth_curve(t, v, at):
    """Natural cubic through (t, v)."""
    n, h = len(t), np.diff(t)
    m = np.eye(n)
    rhs = np.zeros(n)
    for i in range(1, n - 1):
        m[i, i - 1:i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        rhs[i] = 6 * ((v[i + 1] - v[i]) / h[i] - (v[i] - v[i - 1]) / h[i - 1])
    bend = np.linalg.solve(m, rhs)
    i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, n - 2)
    d, w = at - t[i], h[i]
    return v[i] + d * ((v[i + 1] - v[i]) / w - w * (2 * bend[i] + bend[i + 1]) / 6) + d ** 2 * bend[i] / 2 + d ** 3 * (bend[i + 1] - bend[i]) / (6 * w)


class Ball:
    """An ellipsoid; `turned`: degrees that its top leans forward."""

    def __init__(self, name, centre, radii, turned=0.0):
        self.name, self.centre, self.radii = name, np.asarray(centre, float), np.asarray(radii, float)
        c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
        self.frame = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])

    def distance(self, p):
        q = (p - self.centre) @ self.frame / self.radii
        k0 = np.linalg.norm(q, axis=-1)
        return k0 * (k0 - 1) / np.maximum(1e-6, np.linalg.norm(q / self.radii, axis=-1))


NOSE_AND_BROW = [Ball("head", [0, 1.624, 0.094], [0.010, 0.030, 0.022], -22), Ball("head", [0, 1.660, 0.070], [0.050, 0.016, 0.020])]


def _shapes():
    """Sizes of a man of 1.75 m and 75 kg: breadths and girths as tailors and anthropometric tables give them."""
    at = {name: np.array(p, float) for name, _, p in JOINTS}
    x, y, z = np.eye(3)
    shapes = [
        Loft("torso", [0, 0, 0], y, x, z, [
            (0.835, 0.095, 0.086, 0, -0.008), (0.89, 0.142, 0.104, 0, -0.009), (0.945, 0.164, 0.112, 0, -0.010), (1.00, 0.160, 0.108, 0, -0.006),
            (1.06, 0.150, 0.103, 0, 0.000), (1.12, 0.145, 0.102, 0, 0.003), (1.19, 0.148, 0.106, 0, 0.004), (1.26, 0.157, 0.114, 0, 0.004),
            (1.33, 0.166, 0.118, 0, 0.000), (1.385, 0.160, 0.108, 0, -0.007), (1.425, 0.130, 0.086, 0, -0.015), (1.46, 0.085, 0.064, 0, -0.022)],
            roundness=2.4, caps=(0.05, 0.03)),
        Loft("neck", [0, 0, 0], y, x, z, [(1.44, 0.060, 0.060, 0, -0.028), (1.49, 0.053, 0.056, 0, -0.023), (1.54, 0.050, 0.053, 0, -0.015), (1.60, 0.050, 0.054, 0, -0.008)]),
        Ball("head", [0, 1.670, -0.014], [0.076, 0.080, 0.094]), Ball("head", [0, 1.622, 0.026], [0.060, 0.080, 0.062], 8),
        Ball("head", [0, 1.560, 0.056], [0.034, 0.024, 0.030]), *NOSE_AND_BROW,
    ]
    for tail, sign in (("_l", 1), ("_r", -1)):
        mirror = np.array([sign, 1, 1])
        arm = ARM * mirror
        palm = np.array([-np.sqrt(0.5), -np.sqrt(0.5), 0.0]) * mirror  # towards the thigh when the arm hangs
        s, w, h, f = (at[name + tail] for name in ("upperarm", "hand", "thigh", "foot"))
        shapes += [
            Loft("shoulder" + tail, np.array([0.035, 1.470, -0.032]) * mirror, np.array([0.9487, -0.3162, 0.0]) * mirror, np.array([0.3162, 0.9487, 0]) * mirror, z,
                 [(0.0, 0.038, 0.046, 0, 0), (0.05, 0.040, 0.052, 0, 0.004), (0.10, 0.046, 0.057, -0.004, 0.012), (0.14, 0.048, 0.057, -0.006, 0.018)]),
            Ball("breast" + tail, np.array([0.076, 1.357, 0.052]) * mirror, [0.084, 0.062, 0.048], 12),
            Ball("seat" + tail, np.array([0.076, 0.905, -0.060]) * mirror, [0.079, 0.083, 0.078]),
            Loft("arm" + tail, s, arm, palm, z, [
                (0.00, 0.056, 0.060, 0, 0), (0.05, 0.055, 0.058, 0, 0.001), (0.11, 0.049, 0.052, 0, 0.003), (0.17, 0.045, 0.049, 0, 0.003), (0.235, 0.039, 0.041, 0, 0),
                (0.285, 0.038, 0.038, 0, -0.002), (0.33, 0.040, 0.040, 0, 0), (0.38, 0.039, 0.039, 0, 0), (0.45, 0.032, 0.034, 0, 0), (0.51, 0.023, 0.030, 0, 0),
                (0.545, 0.020, 0.029, 0, 0)], caps=(0.05, 0.02)),
            Loft("hand" + tail, w, arm, palm, z, [
                (-0.01, 0.018, 0.026, 0, 0), (0.03, 0.0165, 0.034, 0, 0.001), (0.07, 0.0155, 0.041, 0.001, 0), (0.10, 0.0135, 0.040, 0.004, -0.001),
                (0.13, 0.0115, 0.036, 0.011, -0.002), (0.165, 0.0095, 0.028, 0.025, -0.003)], roundness=2.3, caps=(0.02, 0.016)),
            Loft("hand" + tail, w + 0.020 * arm + [0, 0, 0.022], _unit(0.70 * arm + 0.62 * z + 0.34 * palm), palm, _unit(z - 0.886 * arm), [
                (0, 0.012, 0.014, 0, 0), (0.035, 0.011, 0.012, 0, 0), (0.068, 0.0085, 0.0085, 0, 0)], caps=(0.01, 0.008)),
            Loft("leg" + tail, [h[0], 0, 0], y, sign * x, z, [
                (0.068, 0.033, 0.040, 0, -0.012), (0.10, 0.034, 0.039, 0, -0.010), (0.15, 0.036, 0.041, 0, -0.008), (0.22, 0.043, 0.049, 0, -0.011), (0.30, 0.053, 0.058, 0, -0.016),
                (0.365, 0.056, 0.060, 0.001, -0.015), (0.43, 0.052, 0.055, 0, -0.006), (0.4986, 0.053, 0.058, 0, 0.003), (0.56, 0.059, 0.064, 0.001, 0.005),
                (0.65, 0.070, 0.076, 0.002, 0.006), (0.75, 0.078, 0.085, 0.004, 0.004), (0.84, 0.081, 0.090, 0.005, -0.003), (0.90, 0.074, 0.082, 0.006, -0.006)], caps=(0.03, 0.07)),
            Loft("foot" + tail, [f[0], 0, 0], z, sign * x, y, [
                (-0.052, 0.028, 0.033, 0, 0.028), (-0.025, 0.034, 0.042, 0, 0.036), (0.01, 0.035, 0.048, 0, 0.042), (0.05, 0.037, 0.042, -0.001, 0.036), (0.09, 0.043, 0.033, -0.002, 0.027),
                (0.125, 0.0475, 0.0265, -0.003, 0.020), (0.155, 0.046, 0.021, -0.006, 0.0155), (0.178, 0.039, 0.018, -0.010, 0.013)], roundness=2.4, caps=(0.018, 0.026)),
        ]
    return shapes


def _unit(v):
    return v / np.linalg.norm(v)


SHAPES = _shapes()
BLEND = 0.016  # m over which shapes melt into each other


def field(p):
    """Smooth union; the limbs of the two sides never melt into each other."""
    total = {0: 0, 1: 0, -1: 0}
    for shape in SHAPES:
        side = 1 if shape.name.endswith("_l") else (-1 if shape.name.endswith("_r") else 0)
        total[side] = total[side] + np.exp(-np.clip(shape.distance(p), -0.3, 0.5) / BLEND)
    return np.minimum(-BLEND * np.log(total[0] + total[1]), -BLEND * np.log(total[0] + total[-1]))


def gradient(field, p, h):
    """Unit normals of the surface, by differences over h metres."""
    g = np.stack([field(p + h * e) - field(p - h * e) for e in np.eye(3)], axis=-1)
    return g / np.maximum(1e-9, np.linalg.norm(g, axis=-1, keepdims=True))


def _step(x, width):
    """0 to 1, smooth over ±width."""
    t = np.clip(0.5 + x / (2 * width), 0, 1)
    return t * t * (3 - 2 * t)


def _chain(along, joints, places, widths):
    """Weights [joint][point] of a limb whose joints take over from each other at `places` along it."""
    out = {joints[0]: np.ones(len(along))}
    for before, joint, place, width in zip(joints, joints[1:], places, widths):
        taken = out[before] * _step(along - place, width)
        out[joint] = taken
        out[before] = out[before] - taken
    return out


def skin_weights(p):
    """Every shape spreads its weights along itself; near two shapes a point follows both."""
    at = {name: np.array(q, float) for name, _, q in JOINTS}
    names = [j[0] for j in JOINTS]
    kinds = sorted({s.name for s in SHAPES})
    near = {k: np.min([s.distance(p) for s in SHAPES if s.name == k], axis=0) for k in kinds}
    for k in kinds:
        if k.endswith("_l"):
            near[k] = np.where(p[:, 0] < -0.004, 9, near[k])
        if k.endswith("_r"):
            near[k] = np.where(p[:, 0] > 0.004, 9, near[k])
    least = np.min(list(near.values()), axis=0)
    weight = np.zeros((len(p), len(names)))
    for k in kinds:
        share = np.exp(-((near[k] - least) / 0.016) ** 1.3)
        share[near[k] > least + 0.06] = 0
        kind, tail = (k[:-2], k[-2:]) if k[-2:] in ("_l", "_r") else (k, "")
        height = p[:, 1]
        trunk = _chain(height, ["pelvis", "spine_01", "spine_02", "chest"], [1.06, 1.18, 1.30], [0.06, 0.06, 0.06])
        if kind in ("torso", "breast", "seat"):
            parts = trunk
        elif kind == "neck":
            parts = _chain(height, ["chest", "neck", "head"], [1.485, 1.575], [0.035, 0.04])
        elif kind == "head":
            parts = {"head": np.ones(len(p))}
        elif kind == "shoulder":
            parts = _chain(np.abs(p[:, 0]), ["chest", "clavicle" + tail, "upperarm" + tail], [0.075, 0.165], [0.05, 0.045])
        elif kind == "arm":
            along = (p - at["upperarm" + tail]) @ (ARM * [1 if tail == "_l" else -1, 1, 1])
            parts = _chain(along, [j + tail for j in ("clavicle", "upperarm", "forearm", "hand")], [-0.01, 0.285, 0.54], [0.05, 0.042, 0.028])
        elif kind == "hand":
            parts = {"hand" + tail: np.ones(len(p))}
        elif kind == "leg":
            parts = _chain(-height, ["pelvis"] + [j + tail for j in ("thigh", "shin", "foot")], [-0.915, -0.4986, -0.075], [0.075, 0.055, 0.035])
        else:
            parts = _chain(p[:, 2], ["foot" + tail, "toes" + tail], [0.127], [0.02])
            up = _step(height - 0.085, 0.025)
            parts = {j: w * (1 - up) for j, w in parts.items()} | {"shin" + tail: up}
        for joint, w in parts.items():
            weight[:, names.index(joint)] += share * w
    return weight / weight.sum(axis=1, keepdims=True)


def smoothed(weights_full, triangles, rounds=6):
    """Laplacian smoothing of weights over the mesh, so that bends spread over a hand's breadth."""
    edges = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1), axis=0)
    degree = np.bincount(edges.reshape(-1), minlength=len(weights_full))[:, None]
    for _ in range(rounds):
        total = np.zeros_like(weights_full)
        np.add.at(total, edges[:, 0], weights_full[edges[:, 1]])
        np.add.at(total, edges[:, 1], weights_full[edges[:, 0]])
        weights_full = 0.5 * weights_full + 0.5 * total / np.maximum(1, degree)
    return weights_full


STEP = 0.0115  # m, of the mesh
LOW = np.array([-0.72, -0.03, -0.22])
COUNTS = np.ceil((np.array([0.72, 1.80, 0.27]) - LOW) / STEP).astype(int)


def skinned(field, gradient, boxes=()):
    """Positions, normals, triangles, four joints a vertex and their weights; bind pose."""
    vertices, triangles = surface_nets(field, LOW, COUNTS, STEP, boxes)
    for _ in range(3):  # onto the surface itself
        vertices = vertices - field(vertices)[:, None] * gradient(vertices)
    normals = gradient(vertices)
    sole = vertices[:, 1] < 0
    vertices[sole, 1] = 0
    weights = smoothed(skin_weights(vertices), triangles)
    order = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    top = np.take_along_axis(weights, order, axis=1)
    return vertices, normals, triangles, order, top / top.sum(axis=1, keepdims=True)


def body_mesh():
    """What the physical body is fitted to: hands are mittens, the head is round."""
    return skinned(field, lambda p: gradient(field, p, 1.5e-3))
