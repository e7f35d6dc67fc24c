"""Walking and running, authored through published peaks (cadence, stance and swing, ranges of hip, knee and ankle, trunk and arms).

In stance the foot rolls over heel, sole and ball without sliding and the leg follows by inverse kinematics; in swing the joints take the
smoothest way through their published peaks to the next contact. The pelvis goes where the floor's force has to be to act under the feet.
Phase 0: first contact of the right foot; the left leg is half a cycle behind.
"""
from dataclasses import dataclass

import numpy as np

from balance import GRAVITY, floor_forces, pelvis_shift, points, waves
from motion import ANKLE, BALL, HEEL, RATE, Motion, X, Y, Z, exp, log, smoothest, turn

FINE = 4  # frames computed per frame kept
SOFT = 4.0  # degrees over which the toes' bend comes to its end
TOES = 0.055  # m from the joint of the toes to the tip that they roll over


@dataclass
class Gait:
    frames: int  # of one cycle, at RATE
    stride: float  # m
    stance: float  # share of the cycle that a foot stands
    width: float  # m between the lines of the feet
    splay: float  # degrees, toes out
    pelvis: tuple  # height of the pelvis: mean, and cosine and sine of twice the phase, m
    pitch: list  # (phase, foot's pitch in degrees) from first contact to lift-off, flat between the two zeros
    toes: float  # most that the toes bend up
    swing: dict  # joint: [(phase, degrees)]
    lean: float
    turn: tuple  # of the pelvis, right side forward: cosine and sine of the phase, degrees
    drop: tuple  # of the pelvis, right side up
    thorax: tuple  # turn of the thorax
    arm: tuple  # shoulder flexion: mean and amplitude; abduction; elbow: mean and amplitude
    pressure: list  # (phase, m before the ankle): where the floor's force acts under a foot
    flight: bool = False


WALK = Gait(
    frames=64, stride=1.36, stance=0.61, width=0.10, splay=6, pelvis=(0.93, -0.0155, -0.006),
    pitch=[(-0.04, 22), (0, 16.5), (0.04, 6), (0.08, 0), (0.34, 0), (0.45, -7), (0.50, -16), (0.55, -34), (0.60, -58)], toes=40,
    swing={"thigh": [(0.72, 10), (0.89, 26.5)], "shin": [(0.725, 60), (0.9, 17)], "foot": [(0.66, -19), (0.85, 3), (0.94, 2)], "toes": [(0.8, 12)]},
    lean=2.5, turn=(3.7, 2.1), drop=(1.9, 2.1), thorax=(-3.0, -1.7), arm=(-6, 17, 7, 27, 11),
    pressure=[(0.0, -0.02), (0.12, 0.065), (0.5, 0.155), (0.61, 0.17)])
RUN = Gait(
    frames=42, stride=2.25, stance=0.345, width=0.05, splay=5, pelvis=(0.896, 0.0, 0.0),
    pitch=[(0, 9), (0.06, 0), (0.13, 0), (0.20, -6), (0.24, -12), (0.28, -21), (0.32, -36), (0.345, -47)], toes=30,
    swing={"thigh": [(0.45, -25), (0.62, 2), (0.84, 48)], "shin": [(0.48, 40), (0.68, 99), (0.84, 62)], "foot": [(0.46, -27), (0.65, -11), (0.85, 6)],
           "toes": [(0.6, 4)]},
    lean=7, turn=(-1.0, -1.1), drop=(2.2, 2.6), thorax=(-15.0, 3.4), arm=(-14, 26, 12, 86, 14),
    pressure=[(0.0, 0.06), (0.10, 0.10), (0.25, 0.15), (0.345, 0.18)], flight=True)


def roll(g, phase):
    """The standing foot: pitch, bend of the toes, and the ankle relative to where the flat foot's ankle is (forward) and the floor (up)."""
    n = g.frames * FINE
    grid = np.arange(-n // 8, n)  # a little before the contact, so that the foot arrives moving
    zeros = [p for p, v in g.pitch if not v]
    flat = (grid >= zeros[0] * n) & (grid <= zeros[1] * n)
    track = smoothest(flat, np.zeros(len(grid)), [(p * n - grid[0], v) for p, v in g.pitch if v])
    pitch = np.interp(phase * n, grid, track)
    # The toes lie flat until they can bend no further; then the foot rolls over their tips.
    tip = -SOFT * np.log1p(np.exp((-pitch - g.toes) / SOFT))
    toes = np.where(pitch > 0, 0, tip - pitch)
    a, tip = np.radians(pitch), np.radians(tip)
    pivot = np.where(pitch > 0, HEEL[2], BALL[2])
    height = np.where(pitch > 0, ANKLE, -BALL[1])  # of the ankle over the pivot
    forward = pivot - np.cos(a) * pivot - np.sin(a) * height
    up = ANKLE - height + np.cos(a) * height - np.sin(a) * pivot
    forward += TOES * (1 - np.cos(tip))
    up -= TOES * np.sin(tip)
    return pitch, toes, forward, up


def leg(m, g, tail, phase):
    """Stance by inverse kinematics on the floor, swing by the smoothest way through the keys."""
    sign, shift = (1, 0.5) if tail == "_l" else (-1, 0.0)
    own = (phase + shift) % 1.0
    standing = own <= g.stance
    pitch, toes, forward, up = roll(g, own)
    heading = turn(Y, sign * g.splay)
    foot = np.tile(heading, (m.frames, 1, 1)) @ turn(X, -pitch)
    lap = np.floor(phase + shift) - shift
    ankle = np.stack([sign * g.width / 2 + np.zeros(m.frames), up, g.stride * lap], axis=1) + forward[:, None] * (heading[0] @ Z)
    beyond = np.where(standing, m.plant(tail, np.where(standing[:, None], ankle, m.root - [0, 0.8, 0]), foot, toes), 0)
    n = m.frames
    start = int(np.ceil(-shift * n)) % n
    for joint in ("thigh", "shin", "foot", "toes"):
        angles = np.degrees(log(m.local[joint + tail]))
        lead = {"thigh": -1, "shin": 1, "foot": -1, "toes": -1}[joint]
        track = np.roll(angles, -start, axis=0)
        fixed = np.roll(standing, -start)
        lead_track = smoothest(fixed, lead * track[:, 0], [(p * n, v) for p, v in g.swing[joint]], periodic=True)
        rest = smoothest(fixed, track[:, 1:], periodic=True)
        m.local[joint + tail] = exp(np.radians(np.roll(np.column_stack([lead * lead_track, rest]), start, axis=0)))
    return beyond


def upper_body(m, g, phase):
    c, s = np.cos(2 * np.pi * phase), np.sin(2 * np.pi * phase)
    wave = lambda a: a[0] * c + a[1] * s
    m.trunk(lean=g.lean * 0.5, side=-wave(g.drop), twist=wave(g.turn), spine_flexion=g.lean * 0.5, spine_side=0.8 * wave(g.drop),
            spine_twist=wave(g.thorax) - wave(g.turn), neck=-g.lean, head_twist=-wave(g.thorax))
    for tail, back in (("_r", c), ("_l", -c)):  # the arm goes back as its leg comes forward
        mean, swing, out, elbow, bend = g.arm
        m.arm(tail, mean - swing * back, out, elbow - bend * back, wrist=-6)


def target_pressure(g, phase):
    """Where the floor's force should act [frame][3], and how much of the weight the floor should bear (runs)."""
    n = len(phase)
    share, at = np.zeros(n), np.zeros((n, 3))
    for sign, shift in ((1, 0.5), (-1, 0.0)):
        own = (phase + shift) % 1.0
        lap = np.floor(phase + shift) - shift
        if g.flight:
            load = np.where(own < g.stance, np.sin(np.pi * np.minimum(1, own / g.stance)) ** 1.25, 0)
        else:  # taken over from the other foot while both stand
            both = g.stance - 0.5
            ramp = lambda u: (lambda v: v * v * v * (10 - 15 * v + 6 * v * v))(np.clip(u, 0, 1))
            load = ramp(own / both) * (1 - ramp((own - 0.5) / both))
        forward = np.interp(own, *np.array(g.pressure).T)
        outward = np.sin(np.radians(g.splay)) * forward
        at += load[:, None] * np.stack([sign * (g.width / 2 + outward), np.zeros(n), g.stride * lap + forward], axis=1)
        share += load
    touching = share > 1e-3
    at[touching] /= share[touching, None]
    return at, share / share.mean(), touching


def make(name, g):
    """The pelvis' path is found by turns: build the motion, see where the floor would have to push, shift."""
    n = g.frames * FINE
    phase = np.arange(n) / n
    seconds, travel = g.frames / RATE, np.array([0, 0, g.stride])
    target, share, touching = target_pressure(g, phase)
    bob, surge = 4 * np.pi * phase, g.stride * (phase - 0.25) + 0.03
    root = np.stack([np.zeros(n), g.pelvis[0] + g.pelvis[1] * np.cos(bob) + g.pelvis[2] * np.sin(bob), surge + 0.016 * np.sin(bob)], axis=1)
    basis, weight = waves(n, 6), np.where(touching, 1.0, 0.0)
    for k in range(14):
        m = Motion(n)
        m.root = root
        upper_body(m, g, phase)
        short = max(np.max(leg(m, g, tail, phase)) for tail in ("_l", "_r"))
        if k == 13:
            break
        if g.flight:  # the body's height follows from the floor's force
            masses, paths = points(m)
            wanted = -np.fft.fft((share - 1) * GRAVITY) / np.maximum(1e-9, (2 * np.pi * np.fft.fftfreq(n, seconds / n)) ** 2)
            wanted[0] = 0
            height = np.tensordot(masses, paths, 1)[:, 1]
            root = root + [[0, 0.7 * d, 0] for d in np.fft.ifft(wanted).real - (height - height.mean())]
        root = root + 0.7 * pelvis_shift(m, seconds, travel, basis, weight, target, 1.0 - weight if g.flight else None)
    force, at = floor_forces(m, seconds, travel)
    loaded = touching & (force[:, 1] > 0.2)
    off = np.linalg.norm((at - target)[loaded][:, [0, 2]], axis=1)
    print(f"{name}: the floor bears {force[:, 1].min():.2f} to {force[:, 1].max():.2f} of the weight, {1000 * np.sqrt(np.mean(off ** 2)):.0f} mm rms from where "
          f"it should; legs {1000 * short:.0f} mm too short at most")
    keep = np.arange(0, n, FINE)
    out = Motion(g.frames + 1)
    out.local = {j: np.concatenate([r[keep], r[:1]]) for j, r in m.local.items()}
    out.root = np.concatenate([m.root[keep], m.root[:1] + travel])
    out.root[:, 2] -= out.root[0, 2]
    return out.clip(name)


def walk():
    return make("walk", WALK)


def run():
    return make("run", RUN)
