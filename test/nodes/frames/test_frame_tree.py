"""The tree of tf: lookups against SciPy, and what no sender may do to it."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from robomech_ros.nodes.frames.history import WINDOW, Sample
from robomech_ros.nodes.frames.tree import MOST_FRAMES, FrameTree, NoTransformError

S = 1_000_000_000
STILL = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def put(tree, child, parent, stamp=0, place=STILL[0], turn=STILL[1], *, static=False, now=0):
    return tree.insert(child, Sample(stamp, parent, place, turn), now, static=static)


def pose(place, turn):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_quat(turn).as_matrix(), place
    return T


@pytest.fixture
def tree():
    return FrameTree()


def test_between_any_two_frames_of_a_random_tree(tree):
    random = np.random.default_rng(3)
    in_root = {"f0": np.eye(4)}
    for k in range(1, 40):
        parent = f"f{random.integers(k)}"
        place, turn = random.standard_normal(3), random.standard_normal(4)
        turn /= np.linalg.norm(turn)
        assert not put(tree, f"f{k}", parent, S, tuple(place), tuple(turn), static=k % 3 == 0)
        in_root[f"f{k}"] = in_root[parent] @ pose(place, turn)
    for _ in range(300):
        a, b = (f"f{k}" for k in random.integers(40, size=2))
        wanted = np.linalg.inv(in_root[a]) @ in_root[b]
        np.testing.assert_allclose(tree.between(a, b).pose, wanted, atol=1e-13)
        np.testing.assert_allclose(tree.between(a, b, S).pose, wanted, atol=1e-13)


def test_turns_and_moves_evenly_between_samples(tree):
    random = np.random.default_rng(5)
    stamps = np.cumsum(random.integers(1, S, 8))
    places, turns = random.standard_normal((8, 3)), Rotation.random(8, rng=random)
    rows = turns.as_quat()
    rows[::2] *= -1.0  # the same turns
    order = random.permutation(8)
    for k in order:
        put(tree, "tool", "base", int(stamps[k]), tuple(places[k]), tuple(rows[k]))
    slerp = Slerp(stamps.astype(float), turns)
    for at in [*stamps.tolist(), *random.integers(stamps[0], stamps[-1], 200).tolist()]:
        found = tree.between("base", "tool", int(at))
        assert found.stamp == at
        np.testing.assert_allclose(found.pose[:3, :3], slerp(float(at)).as_matrix(), atol=1e-7)
        wanted = [np.interp(at, stamps, column) for column in places.T]
        np.testing.assert_allclose(found.pose[:3, 3], wanted, atol=1e-9)


def test_now_is_the_last_instant_at_which_all_were_heard_of(tree):
    put(tree, "base", "world", static=True, place=(1.0, 0.0, 0.0))
    for k in range(11):
        put(tree, "tool", "base", k * S, (0.0, float(k), 0.0))
        if k < 8:
            put(tree, "object", "tool", k * S, (0.0, 0.0, float(k)))
    found = tree.between("world", "object")
    assert (found.stamp, found.slowest) == (7 * S, "object")
    np.testing.assert_allclose(found.pose[:3, 3], (1.0, 7.0, 7.0))
    # A frame that is heard of seldom does not make the others unknown.
    for k in range(11, 40):
        put(tree, "tool", "base", k * S, (0.0, float(k), 0.0))
    np.testing.assert_allclose(tree.between("world", "object").pose[:3, 3], (1.0, 29.0, 7.0))


def test_static_frames_hold_at_every_instant(tree):
    put(tree, "base", "world", 5 * S, (1.0, 0.0, 0.0), static=True)
    found = tree.between("world", "base", 1)
    assert found.stamp is None
    np.testing.assert_allclose(found.pose[:3, 3], (1.0, 0.0, 0.0))
    put(tree, "base", "world", 6 * S, (2.0, 0.0, 0.0), static=True)
    assert tree.between("world", "base").pose[0, 3] == 2.0


def test_instants_that_are_not_kept(tree):
    for k in range(20):
        put(tree, "tool", "base", k * S)
    with pytest.raises(NoTransformError, match=r"stamp is 0.5 s newer .* 'tool' in 'base'") as new:
        tree.between("base", "tool", 19 * S + S // 2)
    assert new.value.may_come
    with pytest.raises(NoTransformError, match=r"stamp is 8 s older .* kept of 'tool'") as old:
        tree.between("base", "tool", S)
    assert not old.value.may_come
    assert tree.between("base", "tool", 19 * S - WINDOW).stamp == 19 * S - WINDOW


def test_two_trees_and_no_frame(tree):
    with pytest.raises(NoTransformError, match="tf has no frames yet"):
        tree.between("base", "world")
    put(tree, "base", "world")
    put(tree, "camera", "room")
    assert tree.frames == ("base", "camera", "room", "world")
    assert "room" in tree
    with pytest.raises(NoTransformError, match="tf has no frame 'moon'"):
        tree.between("base", "moon")
    text = "two trees that are not connected: 'camera' hangs on 'room', 'base' on 'world'"
    with pytest.raises(NoTransformError, match=text):
        tree.between("base", "camera")


@pytest.mark.parametrize("length", [2, 3, 900])
def test_a_circle_is_named(tree, length):
    for k in range(length):
        put(tree, f"c{k}", f"c{(k + 1) % length}")
    put(tree, "base", "c0")
    for target, source in (("base", "c1"), ("c1", "base"), ("base", "moon")):
        with pytest.raises(NoTransformError, match="round in a circle|no frame 'moon'"):
            tree.between(target, source)


def test_a_frame_that_changes_its_parent(tree):
    put(tree, "left", "base", static=True, place=(1.0, 0.0, 0.0))
    put(tree, "right", "base", static=True, place=(-1.0, 0.0, 0.0))
    put(tree, "part", "left", S)
    put(tree, "part", "right", 3 * S)
    assert tree.between("base", "part").pose[0, 3] == -1.0
    # Between the two it is still with the first, as in tf2.
    assert tree.between("base", "part", 2 * S).pose[0, 3] == 1.0


BAD = {
    "itself": ("a", "a", STILL[0], STILL[1], "need two names"),
    "no name": ("", "a", STILL[0], STILL[1], "need two names"),
    "no parent": ("a", "", STILL[0], STILL[1], "need two names"),
    "a long name": ("a" * 300, "b", STILL[0], STILL[1], "more than 255 characters"),
    "NaN": ("a", "b", (np.nan, 0.0, 0.0), STILL[1], "not finite"),
    "infinite turn": ("a", "b", STILL[0], (0.0, 0.0, np.inf, 1.0), "not finite"),
    "no turn": ("a", "b", STILL[0], (0.0, 0.0, 0.0, 0.0), "quaternion has norm 0"),
    "a large turn": ("a", "b", STILL[0], (0.0, 0.0, 1e300, 1.0), "quaternion has norm inf"),
    "far away": ("a", "b", (0.0, 1e7, 0.0), STILL[1], "more than 1e\\+06 m away"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_transform_is_passed_over(tree, case):
    child, parent, place, turn, text = BAD[case]
    fault = put(tree, child, parent, 1, place, turn)
    assert re.search(text, fault)
    assert tree.frames == ()


def test_memory_is_bounded(tree):
    for k in range(120_000):
        put(tree, f"f{k % 1200}", "base", k * 50_000)
    kept = [len(history) for history in tree._histories.values()]
    assert sum(kept) <= 100_000
    assert min(kept) >= 1
    assert len(tree.frames) == MOST_FRAMES + 1
    assert "1000 frames already" in put(tree, "one more", "base")
    # Those that are known still move, also the static ones.
    known = tree.frames[1]
    assert not put(tree, known, "base", 400 * S, (7.0, 0.0, 0.0))
    assert tree.between("base", known).pose[0, 3] == 7.0


def test_a_clock_that_was_wrong_or_begins_anew(tree):
    put(tree, "tool", "base", 1000 * S, now=0)
    put(tree, "tool", "base", 5 * S, (1.0, 0.0, 0.0), now=5 * S)
    assert tree.between("base", "tool").stamp == 5 * S
    # Of an old message of a sound clock nothing is kept.
    put(tree, "tool", "base", 100 * S, now=100 * S)
    put(tree, "tool", "base", 6 * S, now=100 * S)
    assert tree.between("base", "tool").stamp == 100 * S
    put(tree, "base", "world", static=True)
    tree.forget_moving()
    assert tree.frames == ("base", "world")
