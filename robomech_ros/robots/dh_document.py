"""A chain written as the YAML form of a Denavit-Hartenberg table."""

import math
from typing import Any

import yaml

from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.robots.limit_arrays import LARGEST_ANGLE
from robomech_ros.spatial import roll_pitch_yaw_from_matrix
from robomech_ros.typing import Array


def dh_document(chain: SerialChain, table: DHTable, source: str) -> str:
    """Write a table with the names, limits and home of a chain; its bodies and drives are left out.

    - ``chain``: chain of n joints.
    - ``table``: table of n joints of the same types.
    - ``source``: source of the numbers, for the document.

    Returns text that :func:`load_robot` reads without loss of any digit.
    """
    links = [f"link_{k + 1}" for k in range(chain.n)]
    document: dict[str, Any] = {
        "name": chain.name,
        "source": source,
        "base_link": chain.base if chain.base not in links else "base_link",
        "tip_link": chain.tip if chain.tip not in links else "tool0",
        "base": _pose(table.base),
        "tool": _pose(table.tool),
        "joints": [_joint(chain, table, k) for k in range(chain.n)],
        "home": dict(zip(chain.joint_names, chain.home().tolist(), strict=True)),
    }
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=100)


def _joint(chain: SerialChain, table: DHTable, k: int) -> dict[str, Any]:
    lower, upper = float(chain.lower[k]), float(chain.upper[k])
    kind = "prismatic" if chain.types[k] == PRISMATIC else "revolute"
    if kind == "revolute" and math.isinf(lower) and math.isinf(upper):
        kind = "continuous"
    row: dict[str, Any] = {"name": chain.joint_names[k], "type": kind}
    row |= {key: float(getattr(table, key)[k]) for key in ("a", "b", "alpha", "theta")}
    if kind != "continuous":
        # As exporters write none.
        row |= {"lower": max(lower, -10.0 * LARGEST_ANGLE)}
        row |= {"upper": min(upper, 10.0 * LARGEST_ANGLE)}
    for key in ("velocity", "acceleration", "jerk", "effort"):
        limit = float(getattr(chain, key)[k])
        if math.isfinite(limit):
            row[key] = limit
    return row


def _pose(T: Array) -> dict[str, list[float]]:
    return {"xyz": T[:3, 3].tolist(), "rpy": roll_pitch_yaw_from_matrix(T[:3, :3]).tolist()}
