"""Motion of the mannequin: rotations, the skeleton's kinematics, legs and arms by inverse kinematics, smooth curves.

glTF axes: x left, y up, z forward; metres, degrees. Flexion, leaning forward and toes up are positive, adduction goes inwards.
"""
import numpy as np

from figure import JOINTS

RATE = 60
AT = {name: np.array(p, float) for name, _, p in JOINTS}
PARENT = {name: parent for name, parent, _ in JOINTS}
NAMES = [j[0] for j in JOINTS]
ANKLE = AT["foot_l"][1]  # height over the sole
BALL = AT["toes_l"] - AT["foot_l"]  # from the ankle to the joint of the toes, about which the heel rises
HEEL = np.array([0.0, -ANKLE, -0.060])  # from the ankle to where the heel meets the floor
X, Y, Z = np.eye(3)


def turn(axis, degrees):
    """Rotation matrices [frame][3][3] about a fixed axis."""
    a = np.radians(np.atleast_1d(np.asarray(degrees, float)))[:, None, None]
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * (k @ k)


def exp(vectors):
    """Rotation vectors [frame][3] (rad) → matrices."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    k = np.zeros((len(vectors), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -vectors[:, 2], vectors[:, 1], -vectors[:, 0]
    k -= np.transpose(k, (0, 2, 1))
    return np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(angle / 2 / np.pi) ** 2 * (k @ k)


def log(m):
    """Matrices → rotation vectors (rad)."""
    q = quaternion(m)
    q *= np.where(q[:, 3:] < 0, -1, 1)
    s = np.linalg.norm(q[:, :3], axis=1, keepdims=True)
    return q[:, :3] * np.where(s > 1e-9, 2 * np.arctan2(s, q[:, 3:]) / np.maximum(s, 1e-9), 2)


def quaternion(m):
    """Matrices → x y z w, sign-aligned from frame to frame."""
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


def rotation_of(q):
    """Quaternions x y z w → matrices."""
    x, y, z, w = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], 1),
                     np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], 1),
                     np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1)], 1)


def smoothest(fixed, values, keys=(), periodic=False):
    """The curve of least jerk through `values` [frame][…] where `fixed` [frame] and, nearly, through `keys` (frame, value)."""
    n = len(fixed)
    values = np.asarray(values, float)
    flat = values.reshape(n, -1)
    rows = np.arange(n if periodic else n - 3)
    d = np.zeros((len(rows), n))
    for k, c in enumerate((-1, 3, -3, 1)):
        d[rows, (rows + k) % n] += c
    rhs = np.zeros((len(rows), flat.shape[1]))
    if keys:
        pins = np.zeros((len(keys), n))
        at = np.array([k[0] for k in keys])
        low = np.floor(at).astype(int)
        pins[np.arange(len(keys)), low % n] += 1 - (at - low)
        pins[np.arange(len(keys)), (low + 1) % n] += at - low
        d = np.concatenate([d, pins])
        rhs = np.concatenate([rhs, np.array([np.atleast_1d(k[1]) for k in keys], float)])
    free = ~np.asarray(fixed, bool)
    out = flat.copy()
    out[free] = np.linalg.lstsq(d[:, free], rhs - d[:, ~free] @ flat[~free], rcond=None)[0]
    return out.reshape(values.shape)


class Motion:
    """Local rotations of all joints and the root's path, frame by frame."""

    def __init__(self, frames):
        self.frames = frames
        self.local = {name: np.tile(np.eye(3), (frames, 1, 1)) for name in NAMES}
        self.root = np.tile(AT["pelvis"], (frames, 1))

    def trunk(self, lean=0, side=0, twist=0, spine_flexion=0, spine_side=0, spine_twist=0, neck=0, head_twist=0):
        """Pelvis lean (about left), tilt (about forward) and turn (about up); the spine shares the rest between three joints."""
        zero = np.zeros(self.frames)
        self.local["pelvis"] = turn(Y, twist + zero) @ turn(Z, side + zero) @ turn(X, lean + zero)
        for name, share in (("spine_01", 0.3), ("spine_02", 0.35), ("chest", 0.35)):
            self.local[name] = turn(Y, share * (spine_twist + zero)) @ turn(Z, share * (spine_side + zero)) @ turn(X, share * (spine_flexion + zero))
        for name in ("neck", "head"):
            self.local[name] = turn(Y, 0.5 * (head_twist + zero)) @ turn(X, 0.5 * (neck + zero))

    def arm(self, tail, flexion, abduction, elbow, wrist=0, twist=0, pronation=0):
        """The palm faces the thigh; `wrist` extends the hand (its back towards the forearm) after the pronation."""
        sign = 1 if tail == "_l" else -1
        zero = np.zeros(self.frames)
        hang = turn(Z, sign * (abduction - 45 + zero))
        bone = AT["forearm" + tail] - AT["upperarm" + tail]
        bone = bone / np.linalg.norm(bone)
        self.local["upperarm" + tail] = turn(X, -(flexion + zero)) @ hang @ turn(bone, sign * (twist + zero))
        axis = turn(Z, sign * 45.0)[0] @ X  # the elbow's axis points left when the arm hangs
        self.local["forearm" + tail] = turn(axis, -(elbow + zero))
        self.local["hand" + tail] = turn(bone, sign * (pronation + zero)) @ turn(Z, sign * (wrist + zero))

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

    def plant(self, tail, ankle, foot, toes, knee_turn=0):
        """Leg by inverse kinematics: ankle path [frame][3], the foot's rotation [frame][3][3], toes bent up by `toes`. The knee points where
        the foot does, turned outwards by `knee_turn`. Returns how far beyond the leg's reach the ankle was, m."""
        sign = 1 if tail == "_l" else -1
        thigh_length, shank_length = (np.linalg.norm(AT[b + tail] - AT[a + tail]) for a, b in (("thigh", "shin"), ("shin", "foot")))
        rotation, place = self.globals()
        reach = ankle - place["thigh" + tail]
        asked = np.linalg.norm(reach, axis=1)
        far, soft = 0.9985 * (thigh_length + shank_length), 0.004
        length = far - soft * np.log1p(np.exp(np.minimum((far - asked) / soft, 50)))  # never quite straight
        bend = np.arccos(np.clip((thigh_length ** 2 + shank_length ** 2 - length ** 2) / (2 * thigh_length * shank_length), -1, 1))
        inner = np.arccos(np.clip((thigh_length ** 2 + length ** 2 - shank_length ** 2) / (2 * thigh_length * length), -1, 1))
        down = reach / asked[:, None]
        left = (turn(Y, sign * (knee_turn + np.zeros(self.frames))) @ foot) @ X
        left -= np.sum(left * down, axis=1, keepdims=True) * down
        left /= np.linalg.norm(left, axis=1, keepdims=True)
        thigh = np.stack([left, -down, np.cross(left, -down)], axis=2) @ turn(X, -np.degrees(inner))
        knee = turn(X, np.degrees(np.pi - bend))
        self.local["thigh" + tail] = np.transpose(rotation["pelvis"], (0, 2, 1)) @ thigh
        self.local["shin" + tail] = knee
        self.local["foot" + tail] = np.transpose(thigh @ knee, (0, 2, 1)) @ foot
        self.local["toes" + tail] = turn(X, -(toes + np.zeros(self.frames)))
        return asked - length

    def clip(self, name, rate=RATE):
        return name, rate, {j: quaternion(self.local[j]) for j in NAMES}, self.root
