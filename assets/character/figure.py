"""Skeleton and mesh of the mannequin: a smooth union of tapered, partly flattened capsules, polygonised by surface nets.

Segment lengths: thigh 0.245, shank 0.246, foot 0.152, upper arm 0.166, forearm 0.146 of a stature of 1.75 m (Drillis & Contini,
de Leva's joint centres).
"""
import numpy as np

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


def _parts():
    """(joint, a, b, radius a, radius b, flattening of depth, blend): capsules in the bind pose."""
    at = {name: np.array(p, float) for name, _, p in JOINTS}
    parts = [
        ("pelvis", [0.05, 0.935, -0.005], [-0.05, 0.935, -0.005], 0.112, 0.112, 0.86), ("pelvis", [0.062, 0.905, -0.045], [-0.062, 0.905, -0.045], 0.082, 0.082, 1.0),
        ("spine_01", [0.035, 1.06, 0], [-0.035, 1.06, 0], 0.105, 0.105, 0.82), ("spine_02", [0.045, 1.17, 0.0], [-0.045, 1.17, 0.0], 0.108, 0.108, 0.82),
        ("chest", [0.062, 1.29, 0.0], [-0.062, 1.29, 0.0], 0.122, 0.122, 0.86), ("chest", [0.085, 1.385, -0.012], [-0.085, 1.385, -0.012], 0.092, 0.092, 0.95),
        ("chest", [0.072, 1.335, 0.055], [-0.072, 1.335, 0.055], 0.064, 0.064, 0.8), ("neck", [0, 1.455, -0.025], [0, 1.56, -0.005], 0.062, 0.054, 1.0),
        ("head", [0, 1.665, -0.006], [0, 1.640, 0.004], 0.088, 0.080, 0.88), ("head", [0, 1.675, -0.028], [0, 1.66, -0.018], 0.083, 0.075, 1.0),
        ("head", [0, 1.60, 0.042], [0, 1.572, 0.052], 0.047, 0.030, 1.0), ("head", [0, 1.625, 0.082], [0, 1.603, 0.096], 0.012, 0.016, 1.0),
    ]
    for tail, sign in (("_l", 1), ("_r", -1)):
        mirror = np.array([sign, 1, 1])
        arm = ARM * mirror
        s, e, w = at["upperarm" + tail], at["forearm" + tail], at["hand" + tail]
        parts += [
            ("clavicle" + tail, np.array([0.05, 1.435, -0.02]) * mirror, np.array([0.15, 1.432, -0.018]) * mirror, 0.062, 0.062, 1.0),
            ("upperarm" + tail, s - 0.012 * arm, s + 0.05 * arm, 0.064, 0.056, 1.0), ("upperarm" + tail, s + 0.05 * arm, e - 0.02 * arm, 0.052, 0.040, 1.0),
            ("upperarm" + tail, s + 0.13 * arm + [0, 0, 0.012], s + 0.19 * arm + [0, 0, 0.010], 0.042, 0.041, 1.0),
            ("forearm" + tail, e - 0.01 * arm, e + 0.07 * arm, 0.041, 0.044, 1.0), ("forearm" + tail, e + 0.07 * arm, w, 0.042, 0.027, 1.0),
            ("hand" + tail, w + 0.015 * arm, w + 0.075 * arm, 0.026, 0.036, 0.55), ("hand" + tail, w + 0.085 * arm, w + 0.165 * arm, 0.034, 0.020, 0.50),
            ("hand" + tail, w + 0.035 * arm + [0, 0, 0.026], w + 0.095 * arm + [0, 0, 0.054], 0.016, 0.012, 1.0),
        ]
        h, k, f = at["thigh" + tail], at["shin" + tail], at["foot" + tail]
        outward = np.array([0.012 * sign, 0, 0])
        parts += [
            ("thigh" + tail, h + [0, -0.01, 0] + outward, h + [0, -0.17, 0.004], 0.090, 0.078, 1.0), ("thigh" + tail, h + [0, -0.17, 0.008], k + [0, 0.05, 0.004], 0.076, 0.056, 1.0),
            ("shin" + tail, k + [0, 0.045, 0.004], k + [0, -0.03, 0.006], 0.056, 0.051, 1.0), ("shin" + tail, k + [0, -0.07, -0.020], k + [0, -0.19, -0.016], 0.050, 0.046, 1.0),
            ("shin" + tail, k + [0, -0.03, 0.004], f + [0, 0.04, -0.008], 0.046, 0.034, 1.0),
            ("foot" + tail, f + [0, 0.012, -0.012], f + [0, -0.034, -0.030], 0.038, 0.034, 1.0), ("foot" + tail, f + [0, -0.012, 0.012], f + [0, -0.042, 0.105], 0.037, 0.026, 1.0),
            ("foot" + tail, f + [0.014 * sign, -0.040, 0.075], f + [-0.014 * sign, -0.040, 0.075], 0.028, 0.028, 1.0),
            ("toes" + tail, f + [0.020 * sign, -0.047, 0.130], f + [-0.022 * sign, -0.046, 0.134], 0.0215, 0.0225, 1.0),
            ("toes" + tail, f + [0.012 * sign, -0.050, 0.160], f + [-0.018 * sign, -0.049, 0.170], 0.0175, 0.0195, 1.0),
        ]
    return parts


PARTS = _parts()
BLEND, INNER = 0.018, 0.007  # m over which joints, and the parts of one joint, melt into each other


def part_distance(part, p):
    _, a, b, ra, rb, flat = part
    a, b = np.asarray(a, float), np.asarray(b, float)
    q = p.copy()
    middle_z = (a[2] + b[2]) / 2
    q[..., 2] = middle_z + (q[..., 2] - middle_z) / flat
    along = b - a
    t = np.clip(((q - a) @ along) / max(1e-12, along @ along), 0, 1)
    return np.linalg.norm(q - (a + t[..., None] * along), axis=-1) - (ra + (rb - ra) * t)


def field(p):
    """Smooth union: parts of one joint melt a little, joints into each other more; the limbs of the two sides never do.
    (A sum of exponentials swells where surfaces coincide, by BLEND·ln 2: hence the small blend within a joint.)"""
    joints = {}
    for part in PARTS:
        e = np.exp(-np.clip(part_distance(part, p), -0.3, 0.5) / INNER)
        joints[part[0]] = joints.get(part[0], 0) + e
    total = {0: 0, 1: 0, -1: 0}
    for name, e in joints.items():
        side = 1 if name.endswith("_l") else (-1 if name.endswith("_r") else 0)
        total[side] = total[side] + (e + 1e-30) ** (INNER / BLEND)
    return np.minimum(-BLEND * np.log(total[0] + total[1]), -BLEND * np.log(total[0] + total[-1]))


def gradient(p, h=1.5e-3):
    g = np.stack([field(p + h * e) - field(p - h * e) for e in np.eye(3)], axis=-1)
    return g / np.maximum(1e-9, np.linalg.norm(g, axis=-1, keepdims=True))


def surface_nets(values, origin, step):
    """One vertex per cell that the surface crosses, a quad per crossed edge."""
    inside = values < 0
    corners = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    n = np.array(values.shape) - 1
    cut = lambda a, c: a[c[0]:c[0] + n[0], c[1]:c[1] + n[1], c[2]:c[2] + n[2]]
    crossed = ~(np.all([cut(inside, c) for c in corners], axis=0) | np.all([~cut(inside, c) for c in corners], axis=0))
    cells = np.argwhere(crossed)
    index = -np.ones(n, np.int64)
    index[tuple(cells.T)] = np.arange(len(cells))
    total, count = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for a in corners:
        for axis in range(3):
            if a[axis]:
                continue
            b = tuple(c + (axis == k) for k, c in enumerate(a))
            va, vb = values[tuple((cells + a).T)], values[tuple((cells + b).T)]
            hit = (va < 0) != (vb < 0)
            t = np.where(hit, va / np.where(hit, va - vb, 1), 0)
            point = cells + a + t[:, None] * (np.array(b) - a)
            total += np.where(hit[:, None], point, 0)
            count += hit
    vertices = origin + step * total / count[:, None]
    quads = []
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        a = inside[tuple(slice(1, -1) for _ in range(3))]
        b = np.roll(inside, -1, axis)[tuple(slice(1, -1) for _ in range(3))]
        edge = np.argwhere(a != b) + 1
        edge = edge[edge[:, axis] < n[axis]]
        q = np.stack([index[tuple((edge - du * u - dv * v).T)] for du, dv in ((1, 1), (0, 1), (0, 0), (1, 0))], axis=1)
        flip = ~inside[tuple(edge.T)]
        q[flip] = q[flip][:, ::-1]
        quads.append(q[(q >= 0).all(axis=1)])
    quads = np.concatenate(quads)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def skin_weights(p):
    """Softness by distance to each joint's parts; limbs of one side never follow the other."""
    names = [j[0] for j in JOINTS]
    distance = np.full((len(p), len(JOINTS)), 9.0)
    for part in PARTS:
        k = names.index(part[0])
        distance[:, k] = np.minimum(distance[:, k], part_distance(part, p))
    for k, name in enumerate(names):
        if name.endswith("_l"):
            distance[p[:, 0] < -0.004, k] = 9
        if name.endswith("_r"):
            distance[p[:, 0] > 0.004, k] = 9
    near = distance.min(axis=1, keepdims=True)
    weight = np.exp(-((distance - near) / 0.020) ** 1.3)
    weight[distance > near + 0.075] = 0
    order = np.argsort(-weight, axis=1, kind="stable")[:, :4]
    top = np.take_along_axis(weight, order, axis=1)
    return order, top / top.sum(axis=1, keepdims=True)


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


def mesh(step=0.014):
    low, high = np.array([-0.72, -0.03, -0.22]), np.array([0.72, 1.80, 0.27])
    counts = np.ceil((high - low) / step).astype(int)
    grid = np.stack(np.meshgrid(*[low[k] + step * np.arange(counts[k]) for k in range(3)], indexing="ij"), axis=-1)
    vertices, triangles = surface_nets(field(grid), low, step)
    for _ in range(3):  # onto the surface itself
        vertices = vertices - field(vertices)[:, None] * gradient(vertices)
    normals = gradient(vertices)
    vertices[:, 1] = np.maximum(vertices[:, 1], 0.0)
    order, weights = skin_weights(vertices)
    full = np.zeros((len(vertices), len(JOINTS)))
    np.put_along_axis(full, order, weights, axis=1)
    full = smoothed(full, triangles)
    order = np.argsort(-full, axis=1, kind="stable")[:, :4]
    top = np.take_along_axis(full, order, axis=1)
    return vertices, normals, triangles, order, top / top.sum(axis=1, keepdims=True)
