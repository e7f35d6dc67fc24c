"""Getting up from back and front, and rolling over: key poses (angles in degrees, z of the pelvis in metres), and what bears on the floor when (shares of the time)."""
import numpy as np

import standing
from contact_motion import FIELDS, RADIUS, SIDES, ContactMotion, places, posed
from motion import RATE, X, Y, turn


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


FOOT = ["heel_in", "heel_out", "ball_in", "ball_out"]
FOOT_L, FOOT_R = [[n + t for n in FOOT] for t in SIDES]
HANDS = _both("palm", "fingers")

# Props itself up on the elbows, then on the hands behind, draws the feet in, and goes over them into a squat.
SUPINE = [
    (0.00, dict(z=-0.60, lean=-90, neck=4, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=8, hip=4, ankle=-3)),
    (0.05, dict(z=-0.60, lean=-90, neck=8, shoulder=-14, abduction=18, elbow=30, arm_twist=-20, knee=8, hip=4, ankle=-3)),
    (0.20, dict(z=-0.55, lean=-66, flexion=30, neck=30, shoulder=-42, abduction=24, elbow=85, knee=20, hip=20, ankle=-5)),
    (0.32, dict(z=-0.48, lean=-48, flexion=28, neck=20, hip_l=75, knee_l=85, hip_r=50, knee_r=60, shoulder_l=-50, elbow_l=70, abduction=25,
                shoulder_r=-55, elbow_r=25, wrist_r=65, arm_twist_r=-30)),
    (0.44, dict(z=-0.42, lean=-28, flexion=25, neck=8, hip=88, knee=100, ankle=10, shoulder=-50, abduction=28, elbow=15, wrist=65, arm_twist=-30)),
    (0.56, dict(z=-0.36, lean=0, flexion=28, neck=-2, hip=112, knee=118, ankle=22, shoulder_l=50, elbow_l=30, abduction_l=12,
                shoulder_r=-35, abduction_r=35, elbow_r=8, wrist_r=65, arm_twist_r=-30)),
    (0.68, dict(z=-0.26, lean=28, flexion=28, neck=-12, spine_twist=-15, hip=122, knee=128, ankle=30, shoulder_l=70, elbow_l=20,
                shoulder_r=-8, abduction_r=40, elbow_r=8, wrist_r=55)),
    (0.74, dict(z=-0.17, lean=42, flexion=25, neck=-25, hip=128, knee=126, ankle=32, shoulder=68, elbow=22, abduction=10)),
    (0.87, dict(z=-0.07, lean=35, flexion=10, neck=-22, hip=82, knee=74, ankle=23, shoulder=35, elbow=26, abduction=9)),
    (0.94, dict(z=-0.02, lean=18, flexion=4, neck=-12, hip=40, knee=36, ankle=13, shoulder=12, elbow=20, abduction=8)),
]
SUPINE_BEARS = [
    (_both("back"), 0, 0.13), (["head"], 0, 0.06), (_both("seat"), 0, 0.60), (_both("heel_in", "heel_out"), 0, 0.20), (_both("elbow"), 0.05, 0.31), (["elbow_l"], 0.05, 0.40),
    (["palm_r", "fingers_r"], 0.29, 0.72), (["palm_l", "fingers_l"], 0.37, 0.56), (FOOT_L, 0.28, 1), (FOOT_R, 0.40, 1)]
# Pushes up to hands and knees, sets one foot after the other behind the hands, and goes back into a squat.
PRONE = [
    (0.00, dict(z=-0.10, lean=90, neck=-12, head_twist=55, shoulder=-6, abduction=24, elbow=16, arm_twist=50, hip=-2, knee=14, ankle=-48)),
    (0.07, dict(z=-0.10, lean=89, flexion=-4, neck=-20, head_twist=20, shoulder=-12, abduction=28, elbow=80, wrist=30, pronation=40, arm_twist=20, hip=0, knee=34, ankle=-40, toes=10)),
    (0.13, dict(z=-0.10, lean=88, flexion=-8, neck=-25, shoulder=-15, abduction=28, elbow=115, wrist=60, pronation=40, hip=6, knee=32, ankle=-12, toes=30)),
    (0.26, dict(z=-0.22, lean=70, flexion=0, neck=-28, shoulder=60, abduction=16, elbow=45, wrist=65, pronation=40, hip=50, knee=75, ankle=0, toes=45)),
    (0.36, dict(z=-0.30, lean=72, flexion=12, neck=-28, shoulder=80, abduction=10, elbow=15, wrist=70, pronation=40, hip=85, knee=92, ankle=5, toes=50)),
    (0.49, dict(z=-0.26, lean=58, flexion=30, neck=-20, hip_l=128, knee_l=120, ankle_l=20, hip_r=75, knee_r=95, ankle_r=5, toes_r=50, shoulder=75, elbow=8, wrist=65, abduction=8)),
    (0.63, dict(z=-0.22, lean=52, flexion=38, neck=-20, hip=130, knee=118, ankle=22, shoulder=72, elbow=5, wrist=50, abduction=8)),
    (0.74, dict(z=-0.18, lean=43, flexion=30, neck=-25, hip=128, knee=126, ankle=32, shoulder=70, elbow=15, abduction=10)),
    (0.86, dict(z=-0.07, lean=35, flexion=10, neck=-22, hip=82, knee=74, ankle=23, shoulder=35, elbow=26, abduction=9)),
    (0.94, dict(z=-0.02, lean=18, flexion=4, neck=-12, hip=40, knee=36, ankle=13, shoulder=12, elbow=20, abduction=8)),
]
PRONE_BEARS = [
    (_both("back"), 0, 0.12), (_both("seat"), 0, 0.13), (_both("thigh_low"), 0, 0.15), (["knee_l"], 0.17, 0.38), (["knee_r"], 0.17, 0.54), (_both("toe_pad_in", "toe_pad_out"), 0.17, 0.37),
    (["toe_pad_in_r", "toe_pad_out_r"], 0.15, 0.55), (HANDS, 0.10, 0.64), (_both("fingers"), 0.10, 0.72), (["ball_in_l", "ball_out_l"], 0.46, 1), (FOOT_L, 0.52, 1),
    (["ball_in_r", "ball_out_r"], 0.62, 1), (FOOT_R, 0.66, 1)]


# From the back over the right side onto the front: the arm that is rolled over lies beyond the head, the other limbs swing across.
ROLL = [
    (0.00, dict(neck=6, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=8, hip=4, ankle=-10)),
    (0.28, dict(neck=20, head_twist=-40, shoulder_r=150, abduction_r=5, elbow_r=15, shoulder_l=80, abduction_l=5, elbow_l=20, spine_twist=-15, hip_l=70, knee_l=85, adduction_l=5, knee_r=8, ankle=-20)),
    (0.50, dict(neck=10, head_twist=-40, shoulder_r=160, abduction_r=5, elbow_r=15, shoulder_l=85, abduction_l=-12, elbow_l=15, spine_twist=-38, hip_l=75, knee_l=70, adduction_l=20, hip_turn_l=-25, knee_r=8, ankle=-30)),
    (0.72, dict(neck=-10, head_twist=-30, shoulder_r=150, abduction_r=15, elbow_r=30, shoulder_l=70, abduction_l=10, elbow_l=40, spine_twist=-25, hip_l=35, knee_l=40, adduction_l=10, knee_r=10, ankle=-40)),
    (1.00, dict(neck=-12, head_twist=30, shoulder_r=60, abduction_r=50, elbow_r=60, shoulder_l=-6, abduction_l=28, elbow_l=30, arm_twist=40, hip=-2, knee=14, ankle=-48)),
]


def _roll(seconds=1.6):
    t = np.linspace(0, 1, int(seconds * RATE) + 1)
    wish = np.array([np.interp(t, [k[0] for k in ROLL], [k[1].get(f, k[1].get(f[:-2], 0.0)) for k in ROLL]) for f in FIELDS]).T
    width = np.hanning(25) / np.hanning(25).sum()
    m = posed(np.array([np.convolve(np.pad(c, 12, mode="edge"), width, "valid") for c in wish.T]).T)
    m.local["pelvis"] = turn(X, -90 + 0 * t) @ turn(Y, -180 * t ** 3 * (10 - 15 * t + 6 * t * t))
    at, _ = places(m)
    low = (at[:, :, 1] - RADIUS[:, None]).min(axis=0)
    m.root = np.stack([0 * t, -low, 0 * t], axis=1) + m.root * [1, 0, 1]
    return m.clip("roll_over")


def clips():
    end = (1.0, _standing_fields())
    for name, seconds, keys, bearing in (("get_up_supine", 3.4, SUPINE, SUPINE_BEARS), ("get_up_prone", 3.2, PRONE, PRONE_BEARS)):
        motion = ContactMotion(seconds, keys + [end], bearing)
        motion.solve()
        yield motion.clip(name)
    yield _roll()
