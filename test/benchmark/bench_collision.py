"""Collisions of a UR5e among twenty boxes: postures against Pinocchio, and proofs of motions."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from table import Row
from timing import Work, interleave

from robomech_ros.collision import Box, PlanningScene
from robomech_ros.robots import load_description
from robomech_ros.trajectory import Limits, sampled_point_to_point

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shaped_arm import shaped_ur5e

BOXES, POSTURES, ROUNDS = 20, 100, 31
CONTACT_TIME, DISTANCE_TIME, PROOF_TIME = 25.0, 50.0, 30_000.0
DURATION, PERIOD = 2.0, 0.01


def rows() -> list[Row]:
    """Measure all; return the rows of the table."""
    text = shaped_ur5e()
    chain = load_description(text).chain()
    scene, rng = PlanningScene(chain), np.random.default_rng(0)
    model = pinocchio.buildModelFromXML(text)
    geometry = pinocchio.buildGeomFromUrdfString(model, text, pinocchio.GeometryType.COLLISION)
    for k in range(BOXES):
        pose, sizes = np.eye(4), rng.uniform(0.05, 0.2, 3)
        pose[:3, 3] = rng.uniform(0.35, 0.8, 3) * rng.choice((-1.0, 1.0), 3)
        scene.add(f"box{k}", Box(*sizes), pose)
        _add_box(geometry, f"box{k}", sizes, pose)
    names = {
        body.name.rsplit("_", 1)[0] if "box" not in body.name else body.name: i
        for i, body in enumerate(geometry.geometryObjects)
    }
    for number in range(len(scene.distances.numbers)):
        first, second = (names[name] for name in scene.distances.names(number))
        geometry.addCollisionPair(pinocchio.CollisionPair(min(first, second), max(first, second)))
    data, found = model.createData(), pinocchio.GeometryData(geometry)
    postures = rng.uniform(-2.0, 2.0, (POSTURES, chain.n))
    timings = interleave(
        {
            "contact": Work(lambda: [scene.is_free(q) for q in postures], POSTURES),
            "pinocchio contact": Work(
                lambda: [
                    pinocchio.computeCollisions(model, data, geometry, found, q, True)
                    for q in postures
                ],
                POSTURES,
            ),
            "distance": Work(lambda: [scene.clearance(q) for q in postures], POSTURES),
            "pinocchio distance": Work(
                lambda: [
                    pinocchio.computeDistances(model, data, geometry, found, q) for q in postures
                ],
                POSTURES,
            ),
        },
        rounds=ROUNDS,
    )
    kinds = (("contact", CONTACT_TIME), ("distance", DISTANCE_TIME))
    return [
        *(
            Row(
                f"{kind} of a posture, 6 joints, {BOXES} boxes",
                timings[kind].median,
                peer=timings[f"pinocchio {kind}"].median,
                peer_name="Pinocchio",
                spread=timings[kind].spread,
                limit=limit,
            )
            for kind, limit in kinds
        ),
        _proof_row(chain, scene),
    ]


def _proof_row(chain: Any, scene: PlanningScene) -> Row:
    """Prove the samples of a motion of two seconds beside the boxes."""
    rng, ends = np.random.default_rng(1), []
    while len(ends) < 2:
        q = rng.uniform(-1.5, 1.5, chain.n)
        if scene.is_free(q) and (not ends or scene.check_motion([ends[0], q]).certified):
            ends.append(q)
    rates = np.full(chain.n, 3.0)
    limits = Limits(
        list(chain.joint_names),
        velocity=rates,
        acceleration=10.0 * rates,
        lower=chain.lower,
        upper=chain.upper,
    )
    motion = sampled_point_to_point(
        *ends, limits=limits, profile="poly345", duration=DURATION, period=PERIOD, max_points=1000
    ).waypoints
    timing = interleave({"ours": Work(lambda: scene.check_motion(motion), 1)}, rounds=ROUNDS)
    ours = timing["ours"]
    what = f"proof of a motion of {DURATION:g} s in {len(motion.times)} samples"
    return Row(what, ours.median, spread=ours.spread, limit=PROOF_TIME)


def _add_box(geometry: Any, name: str, sizes: Any, pose: Any) -> None:
    import coal

    place = pinocchio.SE3(pose[:3, :3], pose[:3, 3])
    body = pinocchio.GeometryObject(name, 0, 0, place, coal.Box(*sizes))
    geometry.addGeometryObject(body)
