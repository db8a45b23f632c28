"""A motion to be shown, and the page that it makes."""

import base64
import re

import numpy as np
import pytest

from robomech_ros.collision import Box, Mesh, PlanningScene
from robomech_ros.errors import BadValueError, RobomechError, UnknownLinkError
from robomech_ros.robots import load_description
from robomech_ros.rolling import load_rolling, rolling_description
from robomech_ros.rolling.tree import BASE_JOINTS
from robomech_ros.rvs import (
    Choice,
    Motion,
    NamedPosture,
    ViewUnavailableError,
    opening,
    view,
    write_motion,
)
from robomech_ros.rvs.model.bodies.solids import box
from robomech_ros.trajectory import interpolant

ROBOT = load_description("ur5e")
CHAIN = ROBOT.chain()
HOME = CHAIN.home()


def motion():
    """Two seconds, in which a posture is chosen after one."""
    times = np.linspace(0.0, 2.0, 41)
    q = HOME + 0.3 * np.sin(times)[:, None] * np.ones(6)
    other = NamedPosture("elbow-up <wrist>", HOME + 0.4)
    return Motion(CHAIN, times, q, (Choice(1.0, "pick", "elbow-down", (other,)),))


def test_a_motion_is_sampled_at_a_rate_with_both_ends():
    given = motion()
    times, q = given.sampled(25.0)
    assert len(times) == 51 and times[0] == 0.0 and times[-1] == 2.0
    np.testing.assert_allclose(q[0], given.q[0])
    np.testing.assert_allclose(q[-1], given.q[-1])


@pytest.mark.parametrize(
    ("times", "q"),
    [
        ([], np.empty((0, 6))),
        ([0.0, 1.0], [HOME]),
        ([0.0, 0.0], [HOME, HOME]),
        ([0.0, np.nan], [HOME, HOME]),
        ([0.0], [HOME * np.nan]),
        ([0.0], [HOME[:5]]),
        ([0.0], "here"),
    ],
)
def test_what_is_no_motion_is_refused(times, q):
    with pytest.raises(RobomechError):
        Motion(CHAIN, times, q)


def test_without_viser_it_is_said_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setattr(opening, "find_spec", lambda _: None)
    with pytest.raises(ViewUnavailableError, match="pip install"):
        view("ur5e", port=0)
    with pytest.raises(ViewUnavailableError, match="pip install"):
        write_motion(tmp_path / "motion.html", ROBOT, motion())


def test_a_page_of_a_motion_names_the_postures_and_needs_nothing_else(tmp_path):
    pytest.importorskip("viser")
    path = write_motion(tmp_path / "motion.html", ROBOT, motion(), title="a <motion>")
    text = path.read_text(encoding="utf-8")
    assert "<title>a &lt;motion&gt;</title>" in text
    assert "elbow-up &lt;wrist&gt;" in text and "elbow-down" in text
    scene = base64.b64decode(re.search('__VISER_EMBED_DATA__="([^"]+)"', text)[1])
    assert 1_000 < len(scene) < 500_000 and path.stat().st_size < 1_500_000
    # No file and no script of elsewhere.
    assert not re.search(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=[\"']?https?:", text)


def test_a_page_of_a_motion_shows_the_objects_of_a_scene(tmp_path):
    pytest.importorskip("viser")
    scene, pose = PlanningScene(CHAIN), np.eye(4)
    pose[:3, 3] = 0.65, 0.25, 0.3
    scene.add("wall", Box(0.4, 0.02, 0.6), pose)
    corners = np.array([[0.0, 0.0, 0.0], [0.11, 0.0, 0.0], [0.0, 0.12, 0.0], [0.0, 0.0, 0.13]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    scene.add("part", Mesh(corners, faces))
    scene.attach("part", "tool0")
    plain, filled = (
        page_of(write_motion(tmp_path / f"{k}.html", ROBOT, motion(), scene=given))[1]
        for k, given in enumerate((None, scene))
    )
    assert b"/object_" not in plain
    wall = box(0.4, 0.02, 0.6).vertices.astype(np.float32)
    for name, vertices in ((b"/base/object_1", wall), (b"tool0/object_2", corners)):
        assert name in filled and np.float32(vertices).tobytes() in filled
    other = PlanningScene(ROBOT, base="shoulder_link")
    with pytest.raises(BadValueError, match="'base_link', the base of the motion"):
        write_motion(tmp_path / "other.html", ROBOT, motion(), scene=other)


def test_a_motion_in_a_folder_that_is_not_there_is_told(tmp_path):
    pytest.importorskip("viser")
    with pytest.raises(FileNotFoundError):
        write_motion(tmp_path / "no" / "motion.html", ROBOT, motion())
    with pytest.raises(BadValueError):
        Motion(CHAIN, [0.0, 1.0], [HOME] * 3)


def test_positions_between_the_times_are_those_of_a_controller():
    times = np.array([0.0, 0.5, 2.0])
    rates = np.array([[0.0] * 6, [0.4] * 6, [0.0] * 6])
    q = HOME + np.array([0.0, 0.1, 0.5])[:, None]
    plan = Motion(CHAIN, times + 3.0, q, qd=rates, qdd=0.0 * rates)
    at = np.linspace(0.0, 2.0, 9)
    np.testing.assert_allclose(
        plan.at(at + 3.0), interpolant(times, q, rates, 0.0 * rates).sample(at).position
    )
    np.testing.assert_allclose(plan.at(100.0), q[-1])
    assert plan.duration == 2.0


@pytest.mark.parametrize("name", ["qd", "qdd", "qddd", "tau"])
def test_rates_and_torques_of_another_size_are_refused(name):
    times, q = [0.0, 1.0], np.array([HOME, HOME])
    for wrong in (HOME, np.full_like(q, np.nan), "fast"):
        with pytest.raises(RobomechError):
            Motion(CHAIN, times, q, **{name: wrong})
    assert getattr(Motion(CHAIN, times, q, **{name: q}), name).shape == (2, 6)


def test_a_whole_robot_moves_and_leaves_its_trail(tmp_path):
    pytest.importorskip("viser")
    cart = rolling_description(load_rolling("mecanum"))
    assert cart.joint_names[:3] == BASE_JOINTS and len(cart.joint_names) == 7
    times = np.linspace(0.0, 4.0, 101)
    q = np.zeros((101, 7))
    q[:, 0], q[:, 1], q[:, 3:] = 3.0 * np.sin(times), times, times[:, None]
    whole = Motion(cart, times, q, (Choice(2.0, "a <way>", "", ()),))
    plain, trailed = (
        page_of(write_motion(tmp_path / f"{link}.html", cart, whole, trail=link))
        for link in ("", "base_link")
    )
    assert "a &lt;way&gt;" in trailed[0] and b"trail" in trailed[1]
    # The line goes through all places, the last of them among its numbers.
    last = whole.at(4.0)[:2].astype(np.float32).tobytes()
    assert last in trailed[1] and len(trailed[1]) > len(plain[1]) + 100 * 24
    assert b"/trail" not in plain[1] and b"/trail" in trailed[1]


def page_of(path):
    """Return the text of a page, and its scene unpacked."""
    text = path.read_text(encoding="utf-8")
    packed = base64.b64decode(re.search('__VISER_EMBED_DATA__="([^"]+)"', text)[1])
    zstandard = pytest.importorskip("zstandard")
    return text, zstandard.ZstdDecompressor().decompress(packed[8:])


@pytest.mark.parametrize(
    ("q", "others", "said"),
    [
        (np.zeros((1, 6)), (), "q"),
        (np.full((1, 7), np.nan), (), "q"),
        (np.zeros((1, 7)), (NamedPosture("other", np.zeros(7)),), "'turn'.*whole robot"),
    ],
)
def test_what_is_no_motion_of_a_whole_robot_is_refused(q, others, said):
    cart = rolling_description(load_rolling("mecanum"))
    with pytest.raises(RobomechError, match=said):
        Motion(cart, [0.0], q, (Choice(0.0, "turn", "", others),))


def test_a_trail_is_of_a_link_of_the_robot(tmp_path):
    pytest.importorskip("viser")
    with pytest.raises(UnknownLinkError, match="nose"):
        write_motion(tmp_path / "motion.html", ROBOT, motion(), trail="nose")
