#!/usr/bin/env python3
"""Writes andrews.json and reference/andrews.csv: Andrews' squeezing mechanism with its published solution.

    andrews.py [DIRECTORY]

Seven plane bodies on hinges, driven by a constant torque. Data and solution at 0.03 s: Test Set for IVP Solvers (University of
Bari), problem `andrews`, after Giles (1978), Manning (1981) and Hairer & Wanner, "Solving Ordinary Differential Equations II",
section VII.7. Files of mechanisms count coordinates from the assembled configuration, the test set from the axes: the test set's
start is the configuration here, so `q:` below is its angle less that of its start.
"""
import json
import math
import pathlib
import sys

# m, m^2 kg, kg, N/m, N m: names of the test set
MASS = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
INERTIA = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
A, B, C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
SPRING, REST = 4530.0, 0.07785
D, DA, E, EA = 28e-3, 115e-4, 2e-2, 1421e-5
RR, RA, SS, SA, SB, SC, SD = 7e-3, 92e-5, 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
TA, TB, U, UA, UB, ZF, ZT, FA = 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5, 2e-2, 4e-2, 1421e-5
TORQUE = 0.033
NAMES = ["beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"]
START = [-0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449, 0.222668390165885884674473185609,
         0.487364979543842550225598953530, -0.222668390165885884674473185609, 1.23054744454982119249735015568]
END_TIME = 0.03
END = [15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
       0.5347301163226948, 1.048080741042263]
END_RATE = [1139.920302151208, -1424.379294994111, 11.03291221937134, 19.29337464421385, 0.5735699284790808,
            -19.29337464421385, 0.3231791658026955]


def at(origin, angle, along, across=0.0):
    """Point `along` the direction of the angle and `across` it, to its left, from an origin."""
    c, s = math.cos(angle), math.sin(angle)
    return (origin[0] + along * c - across * s, origin[1] + along * s + across * c)


def mechanism():
    beta, theta, gamma, phi, delta, omega, epsilon = START
    p = at((0, 0), beta, RR)
    end = at(p, beta + theta, -D)
    q5 = at(A, delta, ZT)
    q7 = at(A, epsilon, 0, -U)
    centers = {"K1": at((0, 0), beta, RA), "K2": at(p, beta + theta, -DA), "K3": at(B, gamma, SB, -SA),
               "K5": at(A, delta, TA, TB), "K4": at(q5, phi + delta, 0, EA - E),
               "K7": at(A, epsilon, UB, -UA), "K6": at(q7, omega + epsilon, ZF - FA)}
    tree = [("beta", "ground", "K1", (0, 0)), ("theta", "K1", "K2", p), ("gamma", "ground", "K3", B),
            ("delta", "ground", "K5", A), ("phi", "K5", "K4", q5), ("epsilon", "ground", "K7", A), ("omega", "K7", "K6", q7)]
    spatial = lambda point: [point[0], point[1], 0.0]
    bodies = []
    for _, _, name, _ in tree:
        i = int(name[1]) - 1
        bodies.append({"name": name, "mass": MASS[i], "com": spatial(centers[name]), "inertia": [INERTIA[i]] * 3 + [0.0] * 3})
    return {
        "format": "sinew-mechanism", "version": 1, "name": "andrews",
        "description": "Andrews' squeezing mechanism: seven plane bodies, one degree of freedom, driven by a constant torque.",
        "source": "Test Set for IVP Solvers, problem andrews; written by andrews.py",
        "gravity": [0.0, 0.0, 0.0], "t_end": END_TIME, "bodies": bodies,
        "joints": [{"name": n, "type": "revolute", "parent": parent, "child": child, "anchor": spatial(anchor), "axis": [0, 0, 1]}
                   for n, parent, child, anchor in tree],
        "loops": [{"name": f"{other}-K2", "type": "point", "body_a": "K2", "body_b": other, "anchor": spatial(end)}
                  for other in ("K3", "K4", "K6")],
        "forces": [{"name": "spring", "type": "spring_damper", "body_a": "K3", "point_a": spatial(at(B, gamma, SD, -SC)),
                    "body_b": "ground", "point_b": spatial(C), "k": SPRING, "l0": REST},
                   {"name": "drive", "type": "torque", "body": "K1", "torque": [0, 0, TORQUE]}],
        "points": [{"name": "E", "body": "K2", "point": spatial(end)}],
    }


def main():
    directory = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    (directory / "andrews.json").write_text(json.dumps(mechanism(), indent=1) + "\n")
    order = [NAMES.index(j["name"]) for j in mechanism()["joints"]]
    head = ["t"] + [f"q:{NAMES[i]}" for i in order] + [f"u:{NAMES[i]}" for i in order]
    rows = [[0.0] * len(head), [END_TIME] + [END[i] - START[i] for i in order] + [END_RATE[i] for i in order]]
    text = ",".join(head) + "\n" + "".join(",".join(repr(x) for x in row) + "\n" for row in rows)
    (directory / "reference" / "andrews.csv").write_text(text)


if __name__ == "__main__":
    main()
