"""Packages whose parts are loaded on first use."""

import inspect
import pkgutil
import re

import pytest

from robomech_ros import (
    cartesian,
    collision,
    dynamics,
    kinematics,
    kinetostatics,
    plotting,
    servo,
    trajectory,
)


@pytest.mark.parametrize(
    "package",
    [cartesian, collision, dynamics, kinematics, kinetostatics, plotting, servo, trajectory],
)
def test_everything_exported_is_there_under_a_name_of_its_own(package):
    """A module of the same name would take its place as soon as it is imported."""
    modules = {found.name for found in pkgutil.iter_modules(package.__path__)}
    assert not modules & set(package.__all__)
    for_types = re.findall(r"(\w+) as \1\b", inspect.getsource(package))
    assert package.__all__ == sorted(for_types)
    assert set(package.__all__) <= set(dir(package))
    for name in package.__all__:
        assert getattr(package, name).__class__.__name__ != "module"
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        package.nothing  # noqa: B018
