"""Robots with shapes, and random objects around them."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from robomech_ros.collision import Box, Capsule, Cone, Cylinder, Mesh, PlanningScene, Sphere
from robomech_ros.robots import load_description
from robomech_ros.spatial import pose_from_position_quaternion

COUPLED = Path(__file__).parents[1] / "data" / "coupled"
# Robots with meshes, outside of the repository.
CELL = next(
    (
        folder / "shared" / "cell"
        for folder in Path(__file__).resolve().parents
        if (folder / "shared" / "cell").is_dir()
    ),
    None,
)

_LIMITS = '<limit lower="{0}" upper="{1}" effort="100" velocity="2" acceleration="5"/>'


def tag(shape):
    """Return the geometry element of a shape."""
    if isinstance(shape, Box):
        return f'<box size="{shape.x} {shape.y} {shape.z}"/>'
    if isinstance(shape, Sphere):
        return f'<sphere radius="{shape.radius}"/>'
    if isinstance(shape, Mesh):
        return f'<mesh filename="{Path(shape.name).name}"/>'
    kind = type(shape).__name__.lower()
    return f'<{kind} radius="{shape.radius}" length="{shape.height}"/>'


def link(name, *shapes):
    """Return a link with shapes at offsets (m)."""
    elements = "".join(
        f'<collision><origin xyz="{x} {y} {z}" rpy="{turn} 0 0"/>'
        f"<geometry>{tag(shape)}</geometry></collision>"
        for shape, (x, y, z), turn in shapes
    )
    return f'<link name="{name}">{elements}</link>'


def joint(name, parent, child, xyz, axis="0 0 1", kind="revolute", limits=(-3, 3), mimic=""):
    """Return a joint."""
    bounds = "" if kind in ("fixed", "continuous") else _LIMITS.format(*limits)
    if kind == "continuous":
        bounds = '<limit effort="100" velocity="2"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{bounds}{mimic}</joint>'
    )


def six_joints():
    """Return the URDF of an arm of boxes, cylinders, capsules and balls."""
    parts = [
        link("base", (Cylinder(0.09, 0.12), (0, 0, 0.06), 0)),
        link("shoulder", (Sphere(0.08), (0, 0, 0), 0)),
        link("upper", (Capsule(0.05, 0.3), (0, 0, 0.2), 0), (Box(0.06, 0.2, 0.06), (0, 0, 0.1), 0)),
        link("fore", (Cylinder(0.04, 0.3), (0, 0, 0.16), 0)),
        link("wrist", (Sphere(0.05), (0, 0, 0), 0)),
        link("bend", (Box(0.06, 0.05, 0.1), (0, 0, 0.04), 0.3)),
        link(
            "hand",
            (Box(0.2, 0.03, 0.04), (0, 0, 0.06), 0),
            (Cylinder(0.02, 0.1), (0.08, 0, 0.12), 0),
        ),
        link("tip"),
        joint("j1", "base", "shoulder", "0 0 0.2"),
        joint("j2", "shoulder", "upper", "0 0.1 0", "0 1 0", limits=(-2, 2)),
        joint("j3", "upper", "fore", "0 -0.1 0.4", "0 1 0", limits=(-2.5, 2.5)),
        joint("j4", "fore", "wrist", "0 0 0.38"),
        joint("j5", "wrist", "bend", "0 0 0", "0 1 0", limits=(-2, 2)),
        joint("j6", "bend", "hand", "0 0 0.1"),
        joint("end", "hand", "tip", "0 0 0.2", kind="fixed"),
    ]
    return f'<robot name="six">{"".join(parts)}</robot>'


def sliding():
    """Return the URDF of an arm on a rail, which turns without limits, with fingers."""
    mimic = '<mimic joint="left" multiplier="-1" offset="0.01"/>'
    parts = [
        link("world"),
        link("rail", (Box(2.0, 0.1, 0.1), (0, 0, 0), 0)),
        link("cart", (Box(0.3, 0.3, 0.1), (0, 0, 0.12), 0)),
        link("arm", (Capsule(0.05, 0.4), (0.25, 0, 0), 1.2), (Sphere(0.1), (0.6, 0, 0), 0)),
        link("lift", (Cylinder(0.03, 0.3), (0, 0, 0), 0)),
        link("palm", (Box(0.15, 0.1, 0.02), (0, 0, 0), 0)),
        link("left_finger", (Box(0.02, 0.02, 0.08), (0.03, 0, -0.05), 0)),
        link("right_finger", (Box(0.02, 0.02, 0.08), (-0.03, 0, -0.05), 0)),
        joint("mount", "world", "rail", "0.1 0.2 0.3", kind="fixed"),
        joint("slide", "rail", "cart", "0 0 0", "1 0 0", "prismatic", (-0.8, 0.8)),
        joint("turn", "cart", "arm", "0 0 0.3", "0 0 1", "continuous"),
        joint("lower", "arm", "lift", "0.6 0 0", "0 0 -1", "prismatic", (-0.1, 0.2)),
        joint("spin", "lift", "palm", "0 0 -0.16", "0 0 1", limits=(-3, 3)),
        joint("left", "palm", "left_finger", "0 0 0", "1 0 0", "prismatic", (0, 0.04)),
        joint("right", "palm", "right_finger", "0 0 0", "1 0 0", "prismatic", (-0.03, 0.01), mimic),
    ]
    return f'<robot name="sliding">{"".join(parts)}</robot>'


def wedge_mesh():
    """Return a mesh that is not convex: an L of unit thickness, scaled to 0.2 m."""
    flat = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    vertices = np.concatenate([np.c_[flat, np.zeros(6)], np.c_[flat, np.ones(6)]]) * 0.1
    cap = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    sides = []
    for i, k in pairwise([0, 1, 2, 3, 4, 5, 0]):
        sides += [[i, k, k + 6], [i, k + 6, i + 6]]
    return vertices, np.concatenate([cap[:, ::-1], cap + 6, sides])


def torus_mesh(radius=0.2, thickness=0.05, around=24, across=12):
    """Return a ring about z."""
    u, v = np.meshgrid(
        2 * np.pi * np.arange(around) / around,
        2 * np.pi * np.arange(across) / across,
        indexing="ij",
    )
    out = radius + thickness * np.cos(v)
    vertices = np.stack([out * np.cos(u), out * np.sin(u), thickness * np.sin(v)], axis=-1)
    faces = []
    for i in range(around):
        for k in range(across):
            a, b = i * across + k, (i + 1) % around * across + k
            c, d = (i + 1) % around * across + (k + 1) % across, i * across + (k + 1) % across
            faces += [[a, b, c], [a, c, d]]
    return vertices.reshape(-1, 3), np.array(faces)


def write_stl(path, vertices, faces):
    """Write an STL in text."""
    rows = ["solid mesh"]
    for face in faces:
        corners = "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in vertices[face].tolist())
        rows.append(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
    path.write_text("\n".join([*rows, "endsolid mesh\n"]))
    return path


def with_meshes(folder):
    """Write an arm of three joints with a mesh on each link, and return the URDF's path."""
    write_stl(folder / "wedge.stl", *wedge_mesh())
    ball = np.random.default_rng(5).normal(size=(40, 3))
    from scipy.spatial import ConvexHull

    hull = ConvexHull(0.1 * ball / np.linalg.norm(ball, axis=1, keepdims=True))
    write_stl(folder / "stone.stl", hull.points, hull.simplices)
    wedge = '<geometry><mesh filename="wedge.stl"/></geometry>'
    stone = '<geometry><mesh filename="package://stones/stone.stl" scale="1 0.8 1.5"/></geometry>'
    (folder / "stones").mkdir()
    (folder / "stones" / "package.xml").write_text("<package><name>stones</name></package>")
    write_stl(folder / "stones" / "stone.stl", hull.points, hull.simplices)
    parts = [
        f'<link name="base"><collision>{wedge}</collision></link>',
        f'<link name="first"><collision>{stone}</collision></link>',
        f'<link name="second"><collision><origin xyz="0 0 0.1"/>{wedge}</collision></link>',
        link("third", (Box(0.05, 0.3, 0.05), (0, 0, 0.1), 0.2)),
        joint("a", "base", "first", "0 0 0.3"),
        joint("b", "first", "second", "0 0 0.3", "0 1 0", limits=(-2, 2)),
        joint("c", "second", "third", "0 0.05 0.35", "1 0 0", limits=(-2.5, 2.5)),
    ]
    path = folder / "meshes.urdf"
    path.write_text(f'<robot name="meshes">{"".join(parts)}</robot>')
    return path


def cell_scene(name):
    """Return the scene of a robot of the cell, and its description."""
    folder = CELL / name
    description = load_description(folder / f"{name}.urdf")
    tips = {"panda": ("panda_link0", "panda_hand"), "ur5": ("base_link", "tool0")}[name]
    chain = description.chain(*tips)
    return PlanningScene(chain, srdf=folder / f"{name}.srdf")


def random_pose(random, reach):
    """Return a random pose in a cube of twice the reach (m)."""
    turn = random.normal(size=4)
    origin = random.uniform(-reach, reach, 3)
    return pose_from_position_quaternion(origin, turn / np.linalg.norm(turn))


def random_shape(random):
    """Return one of the shapes, of 2 to 40 cm."""
    a, b, c = random.uniform(0.02, 0.4, 3)
    kinds = (
        Box(a, b, c),
        Sphere(0.5 * a),
        Cylinder(0.5 * a, b),
        Capsule(0.5 * a, b),
        Cone(0.5 * a, b),
    )
    return kinds[random.integers(len(kinds))]


def random_postures(chain, random, count):
    """Return postures (count, n) within the limits, or half a turn."""
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return random.uniform(lower, upper, (count, chain.n))


def without_self_contact(scene):
    """Return a scene in which only objects count."""
    found = scene.copy()
    for one in found.bodies:
        for other in found.bodies:
            if one not in found.objects and other not in found.objects:
                found.allow(one, other)
    return found
