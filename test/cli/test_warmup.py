"""Kernels that ``robomech warmup`` compiles, and their order."""

from argparse import Namespace

import pytest
from numba.core.compiler import Flags
from numba.core.targetconfig import TargetConfig

from robomech_ros._kernels.compiling.sources import sources
from robomech_ros.cli import warmup
from robomech_ros.errors import UnknownRobotError


def test_only_what_is_stale_is_compiled(monkeypatch):
    digests = {name: sources().digest(name) for name in warmup.kernel_modules()}
    stale = ["inverse.one_pose", "timing.peaks"]
    known = {digest for name, digest in digests.items() if name not in stale}
    asked, kept = [], []
    monkeypatch.setattr(warmup, "compiled", lambda place: known)
    monkeypatch.setattr(warmup, "_compiled_in_parallel", lambda names: asked.extend(names) or [])
    monkeypatch.setattr(warmup, "prune", lambda place, home, digests: kept.extend(digests))
    warmup.warm(silent=True)
    assert asked == stale
    assert sorted(kept) == sorted(digests.values())


@pytest.mark.parametrize(
    ("robot", "kind", "used", "unused"),
    [
        ("ur5e", "", "inverse", {"parallel", "loops", "rolling", "walking", "hands", "collision"}),
        ("ur5e", warmup.OBSTACLES, "collision", {"parallel", "loops", "rolling", "walking"}),
        ("ur5e", "calibration", "calibration", {"parallel", "rolling", "walking", "hands"}),
        ("delta", "parallel", "loops", {"rolling", "walking", "hands", "calibration"}),
        ("hexapod", "walking", "walking", {"parallel", "rolling", "hands", "calibration"}),
    ],
)
def test_a_demonstration_needs_no_kernels_of_other_kinds(robot, kind, used, unused):
    folders = {name.partition(".")[0] for name in warmup.demonstration_modules(robot, kind)}
    assert used in folders
    assert not folders & (unused | {"servo"})


def test_only_redundant_arms_need_the_kernels_of_self_motions():
    """They take a quarter of the time that all of an arm need."""
    for robot, needed in (("panda", True), ("puma560", False), ("nonsense", False)):
        names = warmup.demonstration_modules(robot, "")
        assert ("inverse.redundant.tracing" in names) == needed
        assert {"inverse.redundant.layout", "inverse.solutions"} <= set(names)


def test_a_robot_that_is_not_there_is_refused_by_name():
    with pytest.raises(UnknownRobotError, match="puma56.*puma560"):
        warmup.run(Namespace(robot="puma56", quiet=True))


def test_what_most_wait_for_comes_first():
    modules = warmup.kernel_modules()
    needs = {name: sources().imported(name).intersection(modules) for name in modules}
    remaining = warmup._remaining(needs)
    for name, others in needs.items():
        assert all(remaining[other] > remaining[name] for other in others)
    assert remaining["chain.serial"] > remaining["timing.peaks"]
    assert remaining["timing.peaks"] == sources().path("timing.peaks").stat().st_size


def test_options_hash_as_numba_has_them(monkeypatch):
    flags = Flags()
    flags.nrt = True
    before, values = (flags.values(), hash(flags)), TargetConfig.values
    monkeypatch.setattr(TargetConfig, "values", values)
    warmup._hash_options_faster()
    assert TargetConfig.values is not values
    assert (flags.values(), hash(flags)) == before
