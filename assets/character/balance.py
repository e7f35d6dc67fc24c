"""Newton's laws for authored motion: where the floor must push, and which path of the pelvis makes it push where the feet are.

Without this a clip asks its joints for torques that no floor could help with. Each body segment is two point masses at its radius of
gyration (de Leva 1996: mass shares, centres, radii).
"""
import numpy as np

from motion import AT

GRAVITY = 9.81
# (joint, far end, share of body mass, centre of mass along the bone, radius of gyration along the bone)
_BONES = [("pelvis", "spine_02", 0.112, 0.2, 0.3), ("spine_02", "chest", 0.163, 0.3, 0.35), ("chest", "neck", 0.160, 0.5, 0.4),
          ("neck", "head", 0.012, 0.5, 0.3), ("head", (0, 1.75, 0), 0.057, 0.45, 0.3)]
for _tail in ("_l", "_r"):
    _BONES += [("upperarm" + _tail, "forearm" + _tail, 0.0271, 0.577, 0.28), ("forearm" + _tail, "hand" + _tail, 0.0223, 0.60, 0.35),
               ("thigh" + _tail, "shin" + _tail, 0.1416, 0.41, 0.329), ("shin" + _tail, "foot" + _tail, 0.0433, 0.44, 0.25),
               ("foot" + _tail, "toes" + _tail, 0.0137, 0.5, 0.4)]


def points(motion, bones=_BONES):
    """Masses (shares of the body's) and paths [point][frame][3] of the body's point masses; `bones` as _BONES."""
    rotation, place = motion.globals()
    masses, paths = [], []
    for joint, far, share, centre, radius in bones:
        bone = (AT[far] if isinstance(far, str) else np.array(far)) - AT[joint]
        for at in (centre - radius, centre + radius):
            masses.append(share / 2)
            paths.append(place[joint] + rotation[joint] @ (at * bone))
    masses = np.array(masses)
    return masses / masses.sum(), np.array(paths)


def acceleration(paths, seconds, travel=None):
    """Second derivative along the frame axis of paths […][frame][3], sampled over `seconds`. `travel`: the step from cycle to cycle of a loop
    whose last frame is not repeated; without it the ends are at rest."""
    n = paths.shape[1]
    if travel is None:
        h = seconds / (n - 1)
        padded = np.concatenate([paths[:, :1], paths, paths[:, -1:]], axis=1)
        return (padded[:, 2:] - 2 * padded[:, 1:-1] + padded[:, :-2]) / h ** 2
    level = paths - np.arange(n)[:, None] / n * travel
    k = 2 * np.pi * np.fft.fftfreq(n, seconds / n)
    return np.fft.ifft(-(k ** 2)[:, None] * np.fft.fft(level, axis=1), axis=1).real


def floor_forces(motion, seconds, travel=None, bones=_BONES):
    """What the floor gives: force per body weight [frame][3], and the point where it acts on the floor [frame][3] (far away in flight)."""
    masses, paths = points(motion, bones)
    force = acceleration(paths, seconds, travel) + [0, GRAVITY, 0]
    total = np.tensordot(masses, force, 1)
    moment = np.tensordot(masses, np.cross(paths, force), 1)
    lift = np.where(np.abs(total[:, 1]) > 1e-3, total[:, 1], 1e-3)
    zero = np.zeros_like(lift)
    return total / GRAVITY, np.stack([moment[:, 2] / lift, zero, -moment[:, 0] / lift], axis=1)


def pelvis_shift(motion, seconds, travel, basis, weight, target, flight=None):
    """Level shift of the pelvis [frame][3], made of the columns of `basis` [frame][k], that brings the floor's force to act at `target`
    [frame][3]: weighted least squares on the moment about it, as if the whole body moved along. `flight` [frame]: where nothing may push
    sideways instead."""
    masses, paths = points(motion)
    total, at = floor_forces(motion, seconds, travel)
    height = np.tensordot(masses, paths, 1)[:, 1:2]
    lift = total[:, 1:2] * GRAVITY
    bend = acceleration(basis.T[:, :, None], seconds, None if travel is None else np.zeros(1))[:, :, 0].T
    rows, shift = weight[:, None] * (lift * basis - height * bend), np.zeros((len(basis), 3))
    for axis in (0, 2):
        right = weight * ((target - at)[:, axis] * lift[:, 0])
        a, b = rows, right
        if flight is not None:
            a = np.concatenate([a, flight[:, None] * bend])
            b = np.concatenate([b, -flight * total[:, axis] * GRAVITY])
        shift[:, axis] = basis @ np.linalg.lstsq(a, b, rcond=1e-9)[0]
    return shift


def waves(n, harmonics):
    """Constant, cosines and sines over one cycle [frame][2·harmonics + 1]."""
    p = 2 * np.pi * np.arange(n) / n
    return np.stack([np.ones(n)] + [f(k * p) for k in range(1, harmonics + 1) for f in (np.cos, np.sin)], axis=1)
