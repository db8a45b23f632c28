"""The cache of kernels: what earlier states of the same installation left is taken away."""

import pytest

from robomech_ros.cli.kernel_cache import KEPT, compiled, prune

# Digests of two modules: the first changes with every state, the second never.
STATES = [(f"{i:016x}", "f" * 16) for i in range(8)]


@pytest.fixture
def cache(tmp_path):
    """A cache with the kernels of all states, and with files that are no kernels."""
    for digest in {digest for state in STATES for digest in state}:
        for name in ("py311.nbi", "py311.1.nbc"):
            (tmp_path / f"arm.solve-inverse.arm-12-{digest}.{name}").write_text("code")
    (tmp_path / f"notes-{STATES[0][0]}.txt").write_text("mine")
    return tmp_path


def kept(cache):
    """Tell which digests still have kernels, both files of each."""
    names = [file.name for file in cache.glob("*.nb[ic]")]
    digests = {name.split(".")[-3 if name.endswith("i") else -4][-16:] for name in names}
    assert len(names) == 2 * len(digests)
    return digests


def use(cache, states, installation="/here"):
    """Use states one after another, the earliest first; give all that was taken away."""
    return [file for state in states for file in prune(cache, installation, state)]


def test_the_latest_states_are_kept(cache):
    taken = use(cache, STATES)
    latest = {digest for state in STATES[-1 - KEPT :] for digest in state}
    assert kept(cache) == latest == compiled(cache)
    assert len(taken) == 2 * (len(STATES) - 1 - KEPT)
    assert not any(file.exists() for file in taken)
    assert use(cache, STATES[-1:]) == []


def test_a_state_that_comes_again_is_the_latest(cache):
    use(cache, [*STATES[:4], STATES[0], *STATES[4:7]])
    assert kept(cache) == {digest for i in (0, 4, 5, 6, 7) for digest in STATES[i]}


def test_what_others_use_is_left_alone(cache):
    use(cache, STATES[:1], installation="/there")
    use(cache, STATES)
    assert kept(cache) >= set(STATES[0])
    assert STATES[1][0] not in kept(cache)
    use(cache, STATES[1:], installation="/there")
    assert STATES[0][0] not in kept(cache)


def test_what_nobody_named_is_left_alone(cache):
    use(cache, STATES[:6])
    assert kept(cache) >= {STATES[6][0], STATES[7][0]}
    assert compiled(cache).isdisjoint({STATES[6][0], STATES[7][0]})


def test_what_is_no_kernel_is_left_alone(cache):
    use(cache, STATES)
    assert (cache / f"notes-{STATES[0][0]}.txt").read_text() == "mine"


def test_a_damaged_note_names_nothing(cache):
    use(cache, STATES[:1], installation="/there")
    (note,) = (cache / "used_by").iterdir()
    note.write_bytes(b"\xf6\x00\xff")
    assert compiled(cache).isdisjoint(STATES[0])
    use(cache, STATES[1:2], installation="/there")
    assert compiled(cache) >= set(STATES[1])


def test_trouble_with_the_cache_is_none_of_the_users(tmp_path):
    place = tmp_path / "file"
    place.write_text("")
    assert compiled(place) == set()
    assert prune(place, "/here", STATES[0]) == []
