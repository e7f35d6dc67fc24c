"""Getting up from back and front: key poses (angles in degrees, z of the pelvis in metres), and what bears on the floor when (shares of the time)."""
import numpy as np

import standing
from contact_motion import SIDES, ContactMotion


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
    (0.00, dict(z=-0.52, lean=-90, neck=4, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=8, hip=4, ankle=-3)),
    (0.06, dict(z=-0.52, lean=-90, neck=6, shoulder=-12, abduction=18, elbow=14, arm_twist=-20, knee=8, hip=4, ankle=-3)),
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
    (0.00, dict(z=0.0, lean=90, neck=-12, head_twist=55, shoulder=-6, abduction=24, elbow=16, arm_twist=50, hip=-2, knee=14, ankle=-48)),
    (0.13, dict(z=0.0, lean=88, flexion=-8, neck=-25, shoulder=-15, abduction=28, elbow=115, wrist=60, pronation=40, hip=4, knee=8, ankle=-15, toes=30)),
    (0.30, dict(z=-0.20, lean=70, flexion=0, neck=-28, shoulder=60, abduction=16, elbow=45, wrist=65, pronation=40, hip=50, knee=75, ankle=0, toes=45)),
    (0.43, dict(z=-0.33, lean=72, flexion=12, neck=-28, shoulder=80, abduction=10, elbow=15, wrist=70, pronation=40, hip=85, knee=92, ankle=5, toes=50)),
    (0.58, dict(z=-0.22, lean=30, flexion=14, neck=-14, hip_l=112, knee_l=100, ankle_l=15, hip_r=30, knee_r=96, ankle_r=5, toes_r=50, shoulder=35, elbow=35, abduction=12)),
    (0.76, dict(z=-0.10, lean=32, flexion=8, neck=-16, hip_l=85, knee_l=72, ankle_l=23, hip_r=40, knee_r=58, ankle_r=10, toes_r=40, shoulder=22, elbow=28, abduction=10)),
    (0.88, dict(z=-0.02, lean=16, flexion=3, neck=-8, hip_l=35, knee_l=28, ankle_l=10, hip_r=40, knee_r=55, ankle_r=-5, shoulder=8, elbow=18, abduction=8)),
]
PRONE_BEARS = [
    (_both("breast"), 0, 0.15), (_both("hip_front"), 0, 0.16), (_both("thigh_front"), 0, 0.14), (["knee_l"], 0.11, 0.40), (["knee_r"], 0.11, 0.62), (["toe_pad_in_l", "toe_pad_out_l"], 0.17, 0.40), (["toe_pad_in_r", "toe_pad_out_r"], 0.17, 0.77),
    (_both("palm", "fingers"), 0.13, 0.46), (["heel_l", "ball_in_l", "ball_out_l"], 0.55, 1), (["heel_r", "ball_in_r", "ball_out_r"], 0.94, 1)]


def clips():
    end = (1.0, _standing_fields())
    for name, seconds, keys, bearing in (("get_up_supine", 3.0, SUPINE, SUPINE_BEARS), ("get_up_prone", 2.8, PRONE, PRONE_BEARS)):
        motion = ContactMotion(seconds, keys + [end], bearing)
        motion.solve()
        yield motion.clip(name)
