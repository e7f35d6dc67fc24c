"""What only pictures need of the mannequin: hands with fingers, and a face. Its physical body is figure.py's."""
import numpy as np

from figure import ARM, BLEND, JOINTS, LOW, NOSE_AND_BROW, SHAPES, STEP, Ball, Loft, gradient, skinned


class Chain:
    """Tapered bones one after the other: points and the radius at each, metres."""

    def __init__(self, points, radii):
        self.points, self.radii = np.asarray(points, float), radii

    def distance(self, p):
        least = None
        for a, b, r, s in zip(self.points, self.points[1:], self.radii, self.radii[1:]):
            t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            d = np.linalg.norm(p - a - t[..., None] * (b - a), axis=-1) - (r + t * (s - r))
            least = d if least is None else np.minimum(least, d)
        return least


def smooth_min(a, b, blend):
    h = np.clip(0.5 + 0.5 * (b - a) / blend, 0, 1)
    return b + (a - b) * h - blend * h * (1 - h)


def smooth_max(a, b, blend):
    return -smooth_min(-a, -b, blend)


class Hand:
    """Palm, thumb and four fingers, at rest: curled a little, the little finger most. Lengths and breadths of a hand of 190 mm."""

    #          knuckle: along, to the thumb; joints; radii; spread and curl, degrees
    FINGERS = [((0.092, 0.0270), (0.042, 0.024, 0.019), (0.0088, 0.0080, 0.0074, 0.0062), 5, (16, 26, 14)),
               ((0.096, 0.0080), (0.046, 0.028, 0.020), (0.0090, 0.0082, 0.0076, 0.0064), 1, (19, 29, 16)),
               ((0.091, -0.0110), (0.042, 0.026, 0.020), (0.0086, 0.0078, 0.0072, 0.0060), -4, (23, 32, 18)),
               ((0.082, -0.0280), (0.034, 0.020, 0.017), (0.0076, 0.0068, 0.0062, 0.0052), -10, (27, 34, 19))]

    def __init__(self, tail, sign):
        wrist = np.array(next(at for name, _, at in JOINTS if name == "hand" + tail), float)
        mirror = np.array([sign, 1, 1])
        along, palm, thumb = ARM * mirror, np.array([-np.sqrt(0.5), -np.sqrt(0.5), 0.0]) * mirror, np.array([0, 0, 1.0])
        place = lambda a, z, depth=0.0: wrist + a * along + z * thumb + depth * palm
        self.palm = Loft("palm", wrist, along, palm, thumb, [
            (-0.01, 0.018, 0.026, 0, 0), (0.03, 0.0165, 0.034, 0.001, 0.001), (0.065, 0.0145, 0.040, 0.002, 0), (0.086, 0.0115, 0.0395, 0.002, -0.001)],
            roundness=2.5, caps=(0.02, 0.010))
        self.thumb = [Chain([place(0.014, 0.014, 0.004), place(0.048, 0.040, 0.012), place(0.080, 0.053, 0.016), place(0.106, 0.058, 0.020)],
                            (0.0150, 0.0115, 0.0098, 0.0078))]
        self.fingers = []
        for (a, z), lengths, radii, spread, curls in self.FINGERS:
            points, flex = [place(a - 0.012, z), place(a, z)], 0.0
            across = np.radians(spread)
            for length, curl in zip(lengths, curls):
                flex += np.radians(curl)
                ahead = np.cos(flex) * (np.cos(across) * along + np.sin(across) * thumb) + np.sin(flex) * palm
                points.append(points[-1] + length * ahead)
            self.fingers.append(Chain(points, (radii[0],) + radii))
        self.middle = place(0.09, 0.0)

    def distance(self, p):
        d = self.palm.distance(p)
        for chain in self.thumb:
            d = smooth_min(d, chain.distance(p), 0.014)
        fingers = np.min([f.distance(p) for f in self.fingers], axis=0)  # never melt into each other
        return smooth_min(d, fingers, 0.008)


class Face:
    """What is added to and taken from the head, at depths below or above its own surface."""

    def __init__(self, head):
        self.front = lambda x, y: _crossing(head, np.array([x, y, 0.0]), np.array([0, 0, 1.0]))
        at = lambda x, y, out: [x, y, self.front(x, y)[2] + out]
        self.added, self.taken = [], []  # shape, blend

        def add(shape, blend):
            self.added.append((shape, blend))

        def pair(make, into, blend):
            for sign in (1, -1):
                into.append((make(sign), blend))

        eye = 1.641
        add(Ball("", at(0, 1.688, -0.034), [0.050, 0.034, 0.032]), 0.036)
        pair(lambda s: Chain([at(s * 0.010, 1.660, -0.006), at(s * 0.028, 1.666, -0.005), at(s * 0.047, 1.657, -0.006)], (0.0060, 0.0062, 0.0040)), self.added, 0.014)
        pair(lambda s: Ball("", at(s * 0.031, eye, 0.004), [0.0185, 0.0115, 0.0120]), self.taken, 0.010)
        pair(lambda s: Ball("", at(s * 0.031, eye, -0.0108), [0.0165, 0.0108, 0.0138]), self.added, 0.0025)
        pair(lambda s: Ball("", at(s * 0.040, 1.617, -0.018), [0.022, 0.014, 0.018]), self.added, 0.024)
        add(Chain([at(0, 1.657, -0.008), at(0, 1.632, 0.003), at(0, 1.609, 0.012)], (0.0064, 0.0074, 0.0088)), 0.010)
        pair(lambda s: Ball("", at(s * 0.0115, 1.6065, -0.003), [0.0070, 0.0068, 0.0100]), self.added, 0.006)
        add(Ball("", at(0, 1.583, -0.010), [0.025, 0.016, 0.013]), 0.014)
        pair(lambda s: Ball("", at(s * 0.0065, 1.5835, -0.001), [0.0155, 0.0046, 0.0070]), self.added, 0.004)
        add(Ball("", at(0, 1.5738, -0.0015), [0.0160, 0.0056, 0.0075]), 0.004)
        add(Ball("", at(0, 1.549, -0.009), [0.022, 0.014, 0.014]), 0.016)
        for sign in (1, -1):
            side = _crossing(head, np.array([0.0, 1.637, -0.012]), np.array([sign * 1.0, 0, 0]))
            ear = side + [sign * 0.001, 0, 0]
            add(Ball("", ear, [0.0090, 0.027, 0.0155], -10), 0.008)
            self.taken.append((Ball("", ear + [sign * 0.0095, 0.003, 0.003], [0.0070, 0.017, 0.0090], -10), 0.004))

    def carve(self, p, d):
        for shape, blend in self.taken:
            d = smooth_max(d, -shape.distance(p), blend)
        for shape, blend in self.added:
            d = smooth_min(d, shape.distance(p), blend)
        return d


def _crossing(field, start, along):
    """Where a ray from inside leaves field < 0."""
    low, high = 0.0, 0.3
    for _ in range(40):
        middle = (low + high) / 2
        inside = field((start + middle * along)[None])[0] < 0
        low, high = (middle, high) if inside else (low, middle)
    return start + low * along


_BODY = [s for s in SHAPES if not s.name.startswith("hand") and s not in NOSE_AND_BROW]
HANDS = {"_l": Hand("_l", 1), "_r": Hand("_r", -1)}


def _union(p, shapes):
    total = {0: 0, 1: 0, -1: 0}
    for shape in shapes:
        side = 1 if shape.name.endswith("_l") else (-1 if shape.name.endswith("_r") else 0)
        total[side] = total[side] + np.exp(-np.clip(shape.distance(p), -0.3, 0.5) / BLEND)
    for tail, side in (("_l", 1), ("_r", -1)):
        hand = HANDS[tail]
        near = np.linalg.norm(p - hand.middle, axis=-1) < 0.3
        d = np.full(p.shape[:-1], 0.5)
        d[near] = hand.distance(p[near])
        total[side] = total[side] + np.exp(-d / BLEND)
    return np.minimum(-BLEND * np.log(total[0] + total[1]), -BLEND * np.log(total[0] + total[-1]))


FACE = Face(lambda p: _union(p, [s for s in _BODY if s.name in ("head", "neck")]))


def field(p):
    """As figure.field, with fingers and face."""
    d = _union(p, _BODY)
    near = np.linalg.norm(p - [0, 1.63, 0.03], axis=-1) < 0.2
    d = np.array(d)
    d[near] = FACE.carve(p[near], d[near])
    return d


def _box(low, high, parts):
    return np.floor((np.array(low) - LOW) / STEP).astype(int), np.ceil((np.array(high) - LOW) / STEP).astype(int), parts


def drawn_mesh():
    """As figure.body_mesh, in finer cells where fingers and face are."""
    boxes = [_box([-0.10, 1.535, -0.04], [0.10, 1.69, 0.135], 3)]
    for hand in HANDS.values():
        points = np.concatenate([chain.points for chain in hand.fingers + hand.thumb])
        boxes.append(_box(points.min(axis=0) - 0.02, points.max(axis=0) + 0.02, 3))
    return skinned(field, lambda p: gradient(field, p, 8e-4), boxes)
