#!/usr/bin/env python3
"""How far the pose in an answer of `landmarkdb query --json` is from the truth that landmarkdb-generate wrote.

Takes ANSWER.json TRUTH.json; prints one line. Exit status 1 when there is no pose, or it is off by more than
0.10 m or 5 degrees, which is what "right" means in this project.
"""

import json
import math
import sys

RIGHT_M = 0.10
RIGHT_DEG = 5.0


def position(T):
    return [T[3], T[7], T[11]]


def rotation(T):
    return [T[0:3], T[4:7], T[8:11]]


def angle_deg(R, S):
    """Of the rotation that takes one into the other: trace(R^T S) = 1 + 2 cos(angle)."""
    trace = sum(R[i][j] * S[i][j] for i in range(3) for j in range(3))
    return math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1.0) / 2.0))))


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        answer = json.load(file)
    with open(sys.argv[2], encoding="utf-8") as file:
        truth = json.load(file)["T_scene_sensor"]
    if not answer["hypotheses"]:
        print(f"against the known truth: no pose ({answer['status']}: {answer.get('reason', '')})")
        return 1
    found = answer["hypotheses"][0]["T_scene_sensor"]
    off_m = math.dist(position(found), position(truth))
    off_deg = angle_deg(rotation(found), rotation(truth))
    right = off_m <= RIGHT_M and off_deg <= RIGHT_DEG
    verdict = "right" if right else "wrong" if answer["status"] == "localized" else f"not right, and answered {answer['status']}"
    print(f"against the known truth: the best pose is {1000 * off_m:.1f} mm and {off_deg:.2f} deg off, {verdict}")
    return 0 if right and answer["status"] == "localized" else 1


if __name__ == "__main__":
    sys.exit(main())
