"""The examples in docstrings of public names: each is run, and the most used functions have one."""

import doctest
import inspect
import pkgutil
from importlib import import_module

import pytest

import robomech_ros

# Printed digits are what a reader sees; examples round, so that they are the same everywhere.
FLAGS = doctest.NORMALIZE_WHITESPACE


def documented():
    """Every example of what a package of the core exports, by the name a user imports."""
    found = {}
    packages = [
        package.name
        for package in pkgutil.iter_modules(robomech_ros.__path__)
        if package.ispkg and package.name not in ("_kernels", "nodes")
    ]
    packages += ["dynamics.symbolic", "kinematics.equations", "kinematics.oracles"]
    for package in (*packages, "parallel.equations"):
        module = import_module(f"robomech_ros.{package}")
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            if inspect.isfunction(value) or inspect.isclass(value):
                where = f"{package}.{name}"
                text = inspect.getdoc(value) or ""
                example = doctest.DocTestParser().get_doctest(text, {}, where, None, 0)
                if example.examples:
                    found[where] = example
    return found


EXAMPLES = documented()
# What the outside calls most, and may not lose its example.
MOST_USED = (
    "robots.load_robot",
    "robots.chain_from_dh",
    "robots.list_robots",
    "kinematics.forward_kinematics",
    "kinematics.inverse_kinematics",
    "kinematics.inverse_kinematics_batch",
    "kinetostatics.jacobian",
    "kinetostatics.singularity_report",
    "kinetostatics.characteristic_length",
    "kinetostatics.condition_number",
    "kinetostatics.manipulability",
    "kinetostatics.workspace_boundary",
    "trajectory.point_to_point",
    "trajectory.spline_through",
    "trajectory.along_path",
    "dynamics.inverse_dynamics",
    "dynamics.mass_matrix",
    "dynamics.bias_torque",
    "dynamics.gravity_torque",
    "dynamics.forward_dynamics",
    "dynamics.simulate",
)


@pytest.mark.parametrize("where", EXAMPLES)
def test_an_example_gives_what_its_docstring_shows(where):
    report = []
    outcome = doctest.DocTestRunner(optionflags=FLAGS).run(EXAMPLES[where], out=report.append)
    assert outcome.failed == 0, "".join(report)


def test_the_most_used_functions_have_examples():
    assert [name for name in MOST_USED if name not in EXAMPLES] == []
    assert len(EXAMPLES) >= 40
