"""Drawn parts of a robot: meshes if they exist, generated bodies if not, ghosts."""

import numpy as np
import pytest

from robomech_ros.kinematics import link_poses
from robomech_ros.robots import list_robots, load_description
from robomech_ros.robots.urdf.mesh_files import MeshError, mesh_file
from robomech_ros.rvs.model.bodies.solids import box, cylinder, sphere
from robomech_ros.rvs.model.bodies.visual_model import load_visual_model
from robomech_ros.rvs.model.ghosts import PALETTE, Ghosts
from robomech_ros.spatial import pose_from_position_quaternion

URDF = """<robot name="two">
  <material name="blue"><color rgba="0 0 1 0.5"/></material>
  <link name="base"><visual><geometry><box size="0.2 0.4 0.6"/></geometry></visual></link>
  <link name="arm"><visual><origin xyz="0 0 0.1" rpy="0 0 1"/>
    <geometry><mesh filename="{mesh}" scale="2 3 4"/></geometry><material name="blue"/>
  </visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
</robot>"""
STL = """solid one
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid one
"""


def volume(solid):
    """Return the volume of a closed surface, positive if its triangles face outwards."""
    a, b, c = (solid.vertices[solid.faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def test_solids_are_closed_and_face_outwards():
    assert volume(box(1.0, 2.0, 3.0)) == pytest.approx(6.0)
    assert volume(cylinder(1.0, 2.0)) == pytest.approx(2.0 * np.pi, rel=0.02)
    assert volume(sphere(1.0)) == pytest.approx(4.0 / 3.0 * np.pi, rel=0.04)
    for solid in (box(1.0, 1.0, 1.0), cylinder(1.0, 1.0), sphere(1.0)):
        edges = {(int(f[i]), int(f[(i + 1) % 3])) for f in solid.faces for i in range(3)}
        assert all((b, a) in edges for a, b in edges)


@pytest.mark.parametrize("robot", list_robots())
def test_every_part_of_every_robot_is_seen(robot):
    seen = load_visual_model(load_description(robot))
    assert not seen.missing
    rigid = {link: link for link in seen.tree.links}
    for joint in seen.tree.joints:
        if not joint.moves:
            rigid[joint.child] = rigid[joint.parent]
    assert {rigid[body.link] for body in seen.bodies} == set(rigid.values())


def described(tmp_path, mesh):
    path = tmp_path / "two.urdf"
    path.write_text(URDF.format(mesh=mesh), encoding="utf-8")
    return load_description(path)


@pytest.mark.parametrize("mesh", ["meshes/one.stl", "package://two_description/meshes/one.stl"])
def test_a_mesh_beside_the_urdf_is_seen_with_scale_pose_and_colour(tmp_path, mesh):
    pytest.importorskip("trimesh")
    folder = tmp_path / "two_description"
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "one.stl").write_text(STL, encoding="utf-8")
    seen = load_visual_model(described(folder, mesh))
    assert not seen.missing
    (body,) = [body for body in seen.bodies if body.link == "arm"]
    np.testing.assert_allclose(body.solid.vertices.max(axis=0), [2.0, 3.0, 0.0])
    assert body.colour == (0.0, 0.0, 1.0, 0.5)
    np.testing.assert_allclose(body.pose[:3, 3], [0.0, 0.0, 0.1])
    np.testing.assert_allclose(body.pose[:2, 0], [np.cos(1.0), np.sin(1.0)])


def test_a_package_is_found_by_the_prefixes_of_ament(tmp_path, monkeypatch):
    place = tmp_path / "prefix" / "share" / "maker" / "meshes"
    place.mkdir(parents=True)
    (place / "one.stl").write_text(STL, encoding="utf-8")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    assert mesh_file("package://maker/meshes/one.stl", None) == place / "one.stl"
    assert mesh_file((place / "one.stl").as_uri(), None) == place / "one.stl"
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "prefix" / "share"))
    assert mesh_file("package://maker/meshes/one.stl", None) == place / "one.stl"


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        ("missing.stl", "is not there"),
        ("package://nobody/one.stl", "is not there"),
        ("../outside.stl", "is outside of every package"),
        ("package://inside/../../outside.stl", "is outside of every package"),
        ("file:///etc/one.stl", "is outside of every package"),
        ("https://example.org/one.stl", "is not there"),
        ("broken.stl", "no triangles|cannot be read"),
        ("broken.glb", "cannot be read"),
        ("empty.stl", "no triangles|cannot be read"),
        ("", "has no name"),
        ("package:///etc/one.stl", "names no package"),
        ("package:////etc/one.stl", "names no package"),
        ("package://%2fetc/one.stl", "names no package"),
        ("model://../one.stl", "names no package"),
        ("one.zip", "is none of .stl"),
        (5000 * "m" + ".stl", "cannot be looked for"),
    ],
)
def test_a_mesh_that_cannot_be_seen_is_named_and_stood_in_for(tmp_path, mesh, said):
    pytest.importorskip("trimesh")
    folder = tmp_path / "inside"
    folder.mkdir()
    (tmp_path / "outside.stl").write_text(STL, encoding="utf-8")
    (folder / "broken.stl").write_bytes(b"\x00\xff" * 50)
    (folder / "broken.glb").write_bytes(b"\x00\xff" * 50)
    (folder / "empty.stl").write_bytes(b"")
    seen = load_visual_model(described(folder, mesh))
    (sentence,) = seen.missing
    assert sentence.startswith("arm: mesh '") and "a generated body stands for it" in sentence
    with pytest.raises(MeshError, match=said):
        from robomech_ros.rvs.model.bodies.mesh_files import read_mesh

        read_mesh(mesh_file(mesh, folder), mesh)
    assert [body for body in seen.bodies if body.link == "arm"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ('<cylinder radius="-0.1" length="0.5"/>', "a cylinder of -0.1 x 0.5 m"),
        ('<cylinder radius="0" length="0.5"/>', "a cylinder of 0 x 0.5 m"),
        ('<cylinder radius="0.1" length="1e39"/>', "a cylinder of 0.1 x 1e+39 m"),
        ('<sphere radius="-1e-3"/>', "a sphere of -0.001 m"),
        ('<box size="0.1 0.2 -0.3"/>', "a box of 0.1 x 0.2 x -0.3 m"),
        ("<sphere/>", "a sphere of 0 m"),
    ],
)
def test_sizes_that_no_body_has_are_named_and_stood_in_for(given, said):
    mesh = '<mesh filename="{mesh}" scale="2 3 4"/>'
    seen = load_visual_model(load_description(URDF.replace(mesh, given)))
    (sentence,) = seen.missing
    assert sentence.startswith(f"arm: {said}") and "a generated body stands for it" in sentence
    (body, *_) = [body for body in seen.bodies if body.link == "arm"]
    assert 0.0 < np.ptp(body.solid.vertices, axis=0).max() < 10.0


def test_a_mesh_scaled_out_of_sight_is_named_and_a_flat_body_is_seen(tmp_path):
    mesh = '<mesh filename="{mesh}" scale="2 3 4"/>'
    flat = load_visual_model(load_description(URDF.replace(mesh, '<box size="1 1 0"/>')))
    assert not flat.missing
    pytest.importorskip("trimesh")
    (tmp_path / "one.stl").write_text(STL, encoding="utf-8")
    (tmp_path / "two.urdf").write_text(
        URDF.format(mesh="one.stl").replace("2 3 4", "2 3e38 4"), encoding="utf-8"
    )
    (sentence,) = load_visual_model(load_description(tmp_path / "two.urdf")).missing
    assert "reaches 3e+38 m from its origin, at most 1e+06 m" in sentence


@pytest.mark.parametrize("robot", ["ur5e", "puma560", "stanford", "iiwa14"])
def test_ghosts_lie_where_the_links_are(robot):
    description = load_description(robot)
    seen, chain = load_visual_model(description), description.chain()
    drawn = seen.tree.chain(chain.base, chain.tip)
    ghosts = Ghosts(drawn, seen.shapes)
    rng = np.random.default_rng(1)
    low, high = np.maximum(chain.lower, -3.0), np.minimum(chain.upper, 3.0)
    postures = list(rng.uniform(low, high, (5, chain.n)))
    pieces = ghosts.placed(postures, PALETTE[:5])
    assert len(pieces.positions) == 5 * ghosts.pieces >= 5 * chain.n
    np.testing.assert_allclose(np.linalg.norm(pieces.wxyz, axis=1), 1.0)
    # The drum of a joint lies on its axis, at the frame of the link that it moves.
    moved = [frame.name for frame in drawn.frames if frame.joints == chain.n]
    last = next(name for name in moved if seen.shapes.get(name))
    at = link_poses(drawn, np.array(postures), [last])[:, 0, :3, 3]
    mine = pieces.positions.reshape(5, -1, 3)
    away = np.linalg.norm(mine - at[:, None], axis=2).min(axis=1)
    assert away.max() < 0.2
    assert ghosts.placed([], []).positions.shape == (0, 3)


def test_what_two_ghosts_have_at_one_place_is_drawn_once():
    description = load_description("ur5e")
    seen, chain = load_visual_model(description), description.chain()
    ghosts = Ghosts(seen.tree.chain(chain.base, chain.tip), seen.shapes)
    one = np.array([0.4, -1.2, 1.5, -0.8, 0.9, 0.2])
    # The shoulder of the second is where that of the first is, the other way round that of the
    # third, and the fourth is elsewhere.
    postures = [one + (turn, bend, 0.0, 0.0, 0.0, 0.0) for turn, bend in
                ((0.0, 0.0), (0.0, 0.5), (np.pi, 0.5), (1.0, 0.5))]  # fmt: skip
    pieces = ghosts.placed(postures, PALETTE[:4])
    seen_at_all = pieces.scales.min(axis=1).reshape(4, -1) > 1e-3
    assert seen_at_all[0].all() and seen_at_all[3].sum() == ghosts.pieces - 1
    # Each alone, with where its pieces are and how they lie.
    alone = [ghosts.placed([q], PALETTE[:1]) for q in postures]
    T = np.array([
        [pose_from_position_quaternion(p, np.roll(w, -1))
         for p, w in zip(one.positions, one.wxyz, strict=True)] for one in alone
    ])  # fmt: skip
    for k, piece in np.ndindex(4, ghosts.pieces):
        near = np.linalg.norm(T[:k, piece, :3, 3] - T[k, piece, :3, 3], axis=1) < 1e-9
        across = np.cross(T[:k, piece, :3, 2], T[k, piece, :3, 2])
        again = near & (np.linalg.norm(across, axis=1) < 1e-9)
        assert seen_at_all[k, piece] != again.any()


def test_links_that_mimic_are_moved_with_the_robot():
    description = load_description("puma560")
    seen = load_visual_model(description)
    places, turns = seen.joint_poses({"waist": 0.5})
    links = [joint.child for joint in seen.moving]
    tree = seen.tree
    expected = tree.link_poses({"waist": 0.5})
    (first,) = [joint for joint in tree.joints if joint.name == "waist"]
    k = links.index(first.child)
    pose = pose_from_position_quaternion(places[k], turns[k])
    np.testing.assert_allclose(expected[first.parent] @ pose, expected[first.child])
