"""The golden arms of chapter 9, and random ones."""

import json
from pathlib import Path

import numpy as np
from general_arms import general_arm, random_postures

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh

GOLDEN = Path(__file__).parents[2] / "data" / "golden"
# Poses with singular postures.
SINGULAR = ("ik6r_diestro_recalled_pose", "ik6r_fanuc_arcmate_recalled_pose")
NAMES = tuple(sorted(path.stem for path in GOLDEN.glob("ik6r_*.json")))
# Arms without a spherical wrist at poses without singular postures: sixteen different roots.
REGULAR = tuple(n for n in NAMES if n not in (*SINGULAR, "ik6r_tsai_morgan_1"))


def golden(name):
    """Return what a golden file holds, the arm and the pose."""
    case = json.loads((GOLDEN / f"{name}.json").read_text())
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = case["R"], case["p"]
    return case, chain_from_dh(case["a"], case["b"], case["alpha"]), T


def arm_and_pose(name):
    """Return a golden arm, or the random arm of a number, with its pose."""
    if isinstance(name, str):
        return golden(name)[1:]
    chain = general_arm(f"random-{name}")
    return chain, forward_kinematics(chain, random_postures(1, name)[0])
