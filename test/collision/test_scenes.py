"""Scenes: what is ignored and why, objects that links carry, files of MoveIt, and meshes."""

import json
import math

import numpy as np
import pytest
from arms import (
    joint,
    link,
    random_postures,
    six_joints,
    torus_mesh,
    with_meshes,
    without_self_contact,
    write_stl,
)
from scipy.spatial import ConvexHull

from robomech_ros.collision import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Mesh,
    MeshError,
    Plane,
    PlanningScene,
    Sphere,
)
from robomech_ros.errors import RobomechError, UnknownLinkError
from robomech_ros.robots import load_description, load_robot


def at(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def ball_robot():
    """Return a scene of a ball of 5 cm on three slides."""
    parts = [link(name) for name in ("base", "a", "b")] + [
        link("tool", (Sphere(0.05), (0, 0, 0), 0)),
        joint("x", "base", "a", "0 0 0", "1 0 0", "prismatic", (-2, 2)),
        joint("y", "a", "b", "0 0 0", "0 1 0", "prismatic", (-2, 2)),
        joint("z", "b", "tool", "0 0 0", "0 0 1", "prismatic", (-2, 2)),
    ]
    return PlanningScene(f'<robot name="ball">{"".join(parts)}</robot>')


def test_each_pair_that_is_ignored_has_its_reason(tmp_path):
    srdf = tmp_path / "six.srdf"
    srdf.write_text(
        '<robot name="six"><disable_collisions link1="upper" link2="wrist" reason="Never"/></robot>'
    )
    plain, scene = PlanningScene(six_joints()), PlanningScene(six_joints(), srdf=srdf)
    reasons = {frozenset(pair): why for pair, why in scene.ignored.items()}
    assert reasons[frozenset(("upper", "wrist"))] == "disabled in the SRDF (Never)"
    assert reasons[frozenset(("upper", "fore"))] == "adjacent"
    assert all(reasons.values())
    before = {frozenset(pair) for pair in plain.ignored}
    assert set(reasons) - before <= {frozenset(("upper", "wrist"))}
    for pair, why in plain.ignored.items():
        if "random postures" in why:
            postures = random_postures(plain.chain, np.random.default_rng(3), 50)
            checked = plain.copy()
            checked.forbid(*pair)
            assert not checked.is_free(postures).any()


def test_chains_of_a_robot_share_its_bodies_and_drop_its_meshes(tmp_path):
    description = load_description(with_meshes(tmp_path))
    path = [one.child for one in description.joints]
    first, second = (PlanningScene(description, tip=tip) for tip in (path[0], path[-1]))
    placed = [scene.distances.placed for scene in (first, second)]
    assert all(a.body is b.body for a, b in zip(*placed, strict=True))
    # A mesh with its tree of boxes takes far more memory than the hulls that stand for it.
    assert all(one.body.surface is None and one.body.triangles is None for one in placed[0])


def test_pairs_are_allowed_and_looked_at_again():
    scene, q = ball_robot(), np.zeros(3)
    scene.add("box", Box(0.2, 0.2, 0.2))
    assert not scene.is_free(q)
    scene.allow("box", "tool", "it is soft")
    assert scene.is_free(q) and scene.ignored["tool", "box"] == "it is soft"
    scene.forbid("tool", "box")
    assert not scene.is_free(q) and ("tool", "box") not in scene.ignored


def test_objects_come_move_and_go():
    scene, q = ball_robot(), np.zeros(3)
    scene.add("box", Box(0.2, 0.2, 0.2), at(1.0, 0.0, 0.0))
    assert scene.bodies == ("tool", "box")
    assert scene.clearance(q).distance == pytest.approx(0.85, abs=1e-9)
    scene.move("box", at(0.0, 0.5, 0.0))
    assert scene.clearance(q).distance == pytest.approx(0.35, abs=1e-9)
    other = scene.copy()
    scene.remove("box")
    assert scene.clearance(q).distance == math.inf and "box" in other.objects
    for action in (scene.remove, lambda name: scene.move(name, np.eye(4)), scene.detach):
        with pytest.raises(RobomechError, match="'box'"):
            action("box")


def test_what_is_attached_moves_until_it_is_put_down():
    scene = ball_robot()
    scene.add("tray", Box(0.3, 0.3, 0.02), at(0.5, 0.0, -0.06))
    scene.add("post", Cylinder(0.05, 1.0), at(0.5, 0.5, 0.0))
    scene.attach("tray", "tool", q=[0.5, 0.0, 0.0])
    assert scene.is_free([0.5, 0.0, 0.0])
    assert not scene.is_free([0.5, 0.35, 0.0])
    assert set(scene.clearance([0.5, 0.35, 0.0]).bodies) == {"tray", "post"}
    scene.detach("tray", q=[-0.5, 0.0, 0.3])
    np.testing.assert_allclose(scene.objects["tray"].pose, at(-0.5, 0.0, 0.24), atol=1e-12)
    assert scene.is_free([0.5, 0.35, 0.0])


def test_touch_links():
    scene, q = PlanningScene(six_joints()), np.array([0.9, 1.3, 0.3, 0.0, 0.4, 0.0])
    scene.add("box", Box(0.05, 0.05, 0.05))
    scene.attach("box", "hand", pose=at(0.0, 0.0, -0.06))
    assert not scene.is_free(q)
    scene.attach("box", "hand", ["bend", "wrist", "fore"], pose=at(0.0, 0.0, -0.06))
    assert scene.is_free(q)
    assert scene.ignored["bend", "box"] == "a link may touch what it carries"


def test_scenes_in_the_layout_of_moveit(tmp_path):
    write_stl(tmp_path / "ring.stl", *torus_mesh())

    def pose(x, y, z):
        return {"position": {"x": x, "y": y, "z": z}, "orientation": {"w": 1.0}}

    given = {
        "world": {
            "collision_objects": [
                {
                    "id": "box",
                    "header": {"frame_id": "base"},
                    "pose": pose(1.0, 0.0, 0.0),
                    "primitives": [
                        {"type": 1, "dimensions": [0.2, 0.2, 0.2]},
                        {"type": "sphere", "dimensions": [0.1]},
                    ],
                    "primitive_poses": [pose(0.0, 0.0, 0.0), pose(0.0, 0.0, 0.3)],
                },
                {
                    "id": "pin",
                    "primitives": [{"type": 3, "dimensions": [0.5, 0.02]}],
                    "primitive_poses": [pose(0.0, 1.0, 0.0)],
                },
                {
                    "id": "hat",
                    "primitives": [{"type": 4, "dimensions": [0.3, 0.1]}],
                    "primitive_poses": [pose(0.0, -1.0, 0.0)],
                },
                {
                    "id": "ring",
                    "meshes": [{"resource": "ring.stl"}],
                    "mesh_poses": [pose(-1.0, 0.0, 0.0)],
                },
                {
                    "id": "floor",
                    "planes": [{"coef": [0, 0, 1, 1]}],
                    "plane_poses": [pose(0.0, 0.0, 0.0)],
                },
            ]
        },
        "robot_state": {
            "attached_collision_objects": [
                {
                    "link_name": "tool",
                    "touch_links": [],
                    "object": {
                        "id": "tray",
                        "header": {"frame_id": "tool"},
                        "primitives": [{"type": 1, "dimensions": [0.1, 0.1, 0.1]}],
                        "primitive_poses": [pose(0.0, 0.0, -0.1)],
                    },
                }
            ]
        },
        "allowed_collision_matrix": {
            "entry_names": ["tool", "pin"],
            "entry_values": [{"enabled": [False, True]}, {"enabled": [True, False]}],
        },
    }
    path = tmp_path / "scene.yaml"
    path.write_text(json.dumps(given))
    scene = ball_robot()
    scene.load(path)
    assert set(scene.objects) == {"box", "pin", "hat", "ring", "floor", "tray"}
    assert isinstance(scene.objects["pin"].parts[0][0], Cylinder)
    assert isinstance(scene.objects["hat"].parts[0][0], Cone)
    assert scene.objects["tray"].link == "tool"
    assert scene.ignored["tool", "pin"] == "allowed by the scene"
    bare = without_self_contact(scene)
    bare.detach("tray")
    bare.remove("tray")
    assert bare.clearance([0.7, 0.0, 0.0]).distance == pytest.approx(0.15, abs=1e-9)
    assert bare.clearance([0.0, 0.0, -0.9]).distance == pytest.approx(0.05, abs=1e-9)
    assert not scene.is_free([1.0, 0.0, 0.3])
    with pytest.raises(RobomechError, match="box"):
        scene.load(path)


@pytest.mark.parametrize(
    "given",
    [
        None,
        3,
        [1],
        {"allowed_collision_matrix": {"entry_names": 3}},
        {"allowed_collision_matrix": {"entry_names": ["tool"], "entry_values": [{"enabled": 3}]}},
        {"allowed_collision_matrix": {"default_entry_names": 3, "default_entry_values": [True]}},
        {"world": 3},
        {"world": {"collision_objects": [3]}},
        {"world": {"collision_objects": [{"id": "a"}]}},
        {
            "world": {
                "collision_objects": [{"id": "a", "primitives": [{"type": 9, "dimensions": [1]}]}]
            }
        },
        {
            "world": {
                "collision_objects": [{"id": "a", "primitives": [{"type": 1, "dimensions": [1]}]}]
            }
        },
        {
            "world": {
                "collision_objects": [
                    {"id": "a", "primitives": [{"type": 2, "dimensions": [math.nan]}]}
                ]
            }
        },
        {"world": {"collision_objects": [{"id": "a", "primitives": [{"type": 2}]}]}},
        {
            "world": {
                "collision_objects": [{"id": "a", "meshes": [{"vertices": [], "triangles": []}]}]
            }
        },
        {
            "world": {
                "collision_objects": [
                    {
                        "id": "a",
                        "header": {"frame_id": "moon"},
                        "primitives": [{"type": 2, "dimensions": [1]}],
                    }
                ]
            }
        },
        {
            "robot_state": {
                "attached_collision_objects": [
                    {
                        "link_name": "moon",
                        "object": {"id": "a", "primitives": [{"type": 2, "dimensions": [1]}]},
                    }
                ]
            }
        },
        {
            "world": {
                "collision_objects": [{"id": "a", "primitives": [{"type": "x", "dimensions": "y"}]}]
            }
        },
        {
            "world": {
                "collision_objects": [{"id": "a", "primitives": [{"type": 2, "dimensions": ["y"]}]}]
            }
        },
        {
            "world": {
                "collision_objects": [
                    {
                        "id": "a",
                        "pose": {"position": {"x": "y"}},
                        "primitives": [{"type": 2, "dimensions": [1]}],
                    }
                ]
            }
        },
    ],
)
def test_malformed_scenes(given):
    with pytest.raises(RobomechError):
        ball_robot().load(given)


@pytest.mark.parametrize("mesh", [Mesh(*torus_mesh(0.3, 0.15))])
def test_inside_of_meshes(mesh):
    scene = ball_robot()
    scene.add("ring", mesh)
    assert scene.is_free([0.0, 0.0, 0.0])
    # Inside of the tube, where no triangle is touched.
    assert not scene.is_free([0.3, 0.0, 0.0])
    assert scene.clearance([0.3, 0.0, 0.0]).distance < 0.0
    assert scene.is_free([0.6, 0.0, 0.0])
    assert not scene.check_motion([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]]).free
    assert scene.check_motion([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]).certified
    apart, padded = scene.clearance(np.zeros(3)).distance, PlanningScene(scene.chain, padding=0.02)
    padded.add("ring", mesh)
    assert apart > 0.05
    assert padded.clearance(np.zeros(3)).distance == pytest.approx(apart - 0.02, abs=1e-6)


def box_mesh(a):
    corners = a * np.array(
        [[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], dtype=float
    )
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh(corners, [t for q in quads for t in ([q[0], q[1], q[2]], [q[0], q[2], q[3]])])


def test_a_closed_box_as_a_mesh_is_a_box():
    meshed, boxed = ball_robot(), ball_robot()
    meshed.add("box", box_mesh(0.3))
    boxed.add("box", Box(0.6, 0.6, 0.6))
    postures = np.random.default_rng(4).uniform(-0.6, 0.6, (100, 3))
    np.testing.assert_allclose(
        meshed.clearance(postures).distance, boxed.clearance(postures).distance, atol=2e-6
    )
    assert not meshed.is_free(np.zeros(3))


def test_meshes_with_too_many_triangles_are_refused_with_their_number(tmp_path):
    path, count = tmp_path / "huge.stl", 1_000_000
    with path.open("wb") as file:
        file.write(bytes(80) + count.to_bytes(4, "little"))
        file.truncate(84 + 50 * count)
    for make in (lambda: Mesh(path), lambda: Mesh(np.eye(3), np.tile([0, 1, 2], (count, 1)))):
        with pytest.raises(MeshError, match="has 1,000,000 triangles, at most 200,000 .* MeshLab"):
            make()
    (tmp_path / "huge.obj").write_bytes(bytes(70_000_000))
    with pytest.raises(MeshError, match="has 70 MB, at most 67 MB"):
        Mesh(tmp_path / "huge.obj")


def test_a_large_round_face_of_a_mesh_is_taken():
    """Its corners are neighbours of one of them: more than coal takes as they are."""
    turns = np.linspace(0.0, 2.0 * np.pi, 600, endpoint=False)
    ring = np.column_stack([0.2 * np.cos(turns), 0.2 * np.sin(turns), np.zeros(600)])
    points = np.concatenate([ring - [0.0, 0.0, 0.1], ring + [0.0, 0.0, 0.1]])
    hull, scene = ConvexHull(points), ball_robot()
    a, b, c = points[hull.simplices].swapaxes(0, 1)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    scene.add("drum", Mesh(points, faces))
    for q, distance in (((0.5, 0.0, 0.0), 0.25), ((0.1, 0.05, 0.4), 0.25), ((0.1, 0.0, 0.0), None)):
        found = scene.clearance(q).distance
        assert found < 0.0 if distance is None else found == pytest.approx(distance, abs=1e-6)


def test_the_uneven_faces_of_a_mesh_hide_nothing():
    """A search along the edges of a hull cannot leave a point that is no corner of it."""
    turns, down = np.linspace(0.0, 2.0 * np.pi, 300, endpoint=False), np.linspace(0.01, 3.13, 8)
    u, v = (one.ravel() for one in np.meshgrid(turns, down))
    points = 0.2 * np.column_stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    drum, scene = Mesh(points, ConvexHull(points).simplices), ball_robot()
    (part,) = drum.parts()
    starts = part.edges[: len(part.corners) + 1]
    assert (np.diff(starts) > 1).all()
    scene.add("drum", drum)
    postures = np.random.default_rng(3).uniform(-0.4, 0.4, (200, 3))
    free = scene.clearance(postures).distance > 0.0
    assert 20 < free.sum() < 180 and (scene.is_free(postures) == free).all()
    assert not scene.check_motion([[0.4, 0.0, 0.0], [-0.4, 0.0, 0.0]]).free


def test_bad_shapes():
    for make in (
        lambda: Box(0.0, 1.0, 1.0),
        lambda: Box(1.0, -1.0, 1.0),
        lambda: Sphere(math.nan),
        lambda: Sphere(math.inf),
        lambda: Cylinder(1.0, 0.0),
        lambda: Capsule(1e9, 1.0),
        lambda: Cone(1.0, "high"),
        lambda: Plane((0, 0, 0)),
        lambda: Plane((0, 0, 1), math.nan),
        lambda: Plane((0, math.nan, 1)),
        lambda: Plane((1e300, 0, 0)),
        lambda: Plane((0, 0, 1e-5), 1.0),
        lambda: Mesh([[0, 0, 0]], [[0, 0, 1]]),
        lambda: Mesh(np.zeros((3, 3)), np.zeros((0, 3), int)),
        lambda: Mesh(np.zeros((3, 2)), [[0, 1, 2]]),
        lambda: Mesh([[0, 0, math.nan]] * 3, [[0, 1, 2]]),
        lambda: Mesh(np.eye(3)),
        lambda: Mesh(np.zeros((3, 3)), [[0, 1, 2]]),
        lambda: Mesh(np.eye(3), [[0, 1, -1]]),
        lambda: Mesh(np.eye(3), [[0, 1, 2]], scale=(0, 1, 1)),
    ):
        with pytest.raises((RobomechError, ValueError, TypeError)):
            make()
    scene = ball_robot()
    thin = ConvexHull(np.random.default_rng(0).normal(size=(900, 3)) * [0.2, 0.2, 1e-9])
    for flat in (Mesh(np.eye(3), [[0, 1, 2]]), Mesh(thin.points, thin.simplices)):
        with pytest.raises(RobomechError, match="a thin box stands for a plate"):
            scene.add("flat", flat)
    assert not scene.objects


def test_bad_objects():
    scene = ball_robot()
    scene.add("box", Box(0.1, 0.1, 0.1), at(1, 0, 0))
    for action in (
        lambda: scene.add("box", Sphere(0.1)),
        lambda: scene.add("tool", Sphere(0.1)),
        lambda: scene.add("", Sphere(0.1)),
        lambda: scene.add("nan", Sphere(0.1), np.full((4, 4), math.nan)),
        lambda: scene.add("skew", Sphere(0.1), 2.0 * np.eye(4)),
        lambda: scene.add("none", []),
        lambda: scene.add("text", "sphere"),
        lambda: scene.add("bare", [Sphere(0.1)]),
        lambda: scene.add("far", Sphere(0.1), at(1e7, 0, 0)),
        lambda: scene.add("no area", Mesh(np.eye(3), [[0, 0, 1]])),
        lambda: scene.move("box", np.full((4, 4), math.nan)),
        lambda: scene.set_other_joints({"x": 0.1}),
        lambda: scene.detach("box"),
    ):
        with pytest.raises(RobomechError):
            action()
    for action in (
        lambda: scene.add("far", Sphere(0.1), frame="moon"),
        lambda: scene.attach("box", "moon"),
        lambda: scene.attach("box", "tool", ["moon"]),
        lambda: scene.link_pose("moon", np.zeros(3)),
    ):
        with pytest.raises(UnknownLinkError, match="moon"):
            action()
    scene.add("floor", Plane((0, 0, 1), -1.0))
    with pytest.raises(RobomechError, match="planes"):
        scene.attach("floor", "tool")
    assert set(scene.objects) == {"box", "floor"} and scene.is_free(np.zeros(3))


def test_meshes_of_links_that_cannot_be_read_are_named_and_the_rest_is_used(tmp_path):
    (tmp_path / "broken.stl").write_text("this is no mesh")
    (tmp_path / "empty.stl").write_bytes(b"")
    write_stl(tmp_path / "flat.stl", np.eye(3), np.array([[0, 1, 2]]))
    names = ["missing.stl", "broken.stl", "empty.stl", "flat.stl"]
    parts = [link("base"), link("good", (Sphere(0.1), (0, 0, 0), 0))]
    parts.append(joint("j", "base", "good", "0 0 0.2"))
    for k, name in enumerate(names):
        mesh = f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'
        parts.append(f'<link name="bad_{k}">{mesh}</link>')
        parts.append(joint(f"f_{k}", "good", f"bad_{k}", "0 0 0.2", kind="fixed"))
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="broken">{"".join(parts)}</robot>')
    scene = PlanningScene(path, tip="good")
    assert set(scene.unchecked) == {f"bad_{k}" for k in range(4)}
    for k, name in enumerate(names):
        assert name in scene.unchecked[f"bad_{k}"]
    assert scene.bodies == ("good",) and scene.has_geometry
    for name in names[:3]:
        with pytest.raises(MeshError, match=name):
            Mesh(tmp_path / name)


def test_a_robot_without_geometry_and_wrong_robots():
    scene = PlanningScene(load_robot("puma560"))
    assert not scene.has_geometry
    scene.add("box", Box(1, 1, 1))
    assert scene.plan(np.zeros(6), np.full(6, 0.1)).certified
    for options in ({"padding": -1.0}, {"padding": math.nan}, {"padding": 2.0}, {"base": "base"}):
        with pytest.raises(RobomechError):
            PlanningScene(load_robot("puma560"), **options)


def test_what_is_refused_changes_nothing():
    scene = PlanningScene(six_joints())
    scene.add("box", Box(0.1, 0.1, 0.1), at(0.5, 0.5, 0.5))
    before = scene.bodies, scene.ignored
    one = {"id": "ball", "primitives": [{"type": 2, "dimensions": [0.1]}]}
    torn = {"id": "torn", "primitives": [{"type": 2, "dimensions": [-1.0]}]}
    with pytest.raises(RobomechError, match="torn"):
        scene.load({"world": {"collision_objects": [one, torn]}})
    with pytest.raises(RobomechError, match="nobody"):
        scene.allow("box", "nobody")
    with pytest.raises(RobomechError, match="touch_links"):
        scene.attach("box", scene.chain.tip, "hand")
    with pytest.raises(RobomechError):
        scene.set_other_joints({"nobody": math.nan})
    assert (scene.bodies, scene.ignored) == before
    scene.clearance(np.zeros(6))
