"""Signatures that ``help`` shows of public functions are readable."""

import importlib
import inspect
import pkgutil
import pydoc
import re

import pytest

import robomech_ros

# Packages with public names; nodes and commands are called by their names.
PACKAGES = [
    module.name
    for module in pkgutil.walk_packages(robomech_ros.__path__, "robomech_ros.")
    if module.ispkg
    and not module.name.startswith(("robomech_ros._", "robomech_ros.nodes", "robomech_ros.cli"))
    and hasattr(importlib.import_module(module.name), "__all__")
]
# Types in full, addresses of objects, and private names.
UNREADABLE = r"numpy\.|typing\.|robomech_ros\.|Union\[| at 0x|<object|\b_\w"


def public_callables(package):
    """Functions and classes of a package, and the methods of these, by their names."""
    module = importlib.import_module(package)
    for name in module.__all__:
        found = getattr(module, name)
        if inspect.isclass(found) or inspect.isfunction(found):
            yield name, found
        if inspect.isclass(found) and found.__module__.startswith("robomech_ros."):
            for method, body in inspect.getmembers(found, inspect.isfunction):
                if not method.startswith("_"):
                    yield f"{name}.{method}", body


@pytest.mark.parametrize("package", PACKAGES)
def test_signatures_are_readable(package):
    """``q: ArrayLike`` took four lines of numpy's private types."""
    unreadable = {}
    for name, found in public_callables(package):
        try:
            text = str(inspect.signature(found))
        except ValueError:  # of an exception, which takes what its base takes
            assert issubclass(found, Exception), name
            continue
        if re.search(UNREADABLE, text):
            unreadable[name] = text
    assert not unreadable


def test_all_packages_with_public_names_are_seen():
    subjects = {name.split(".")[1] for name in PACKAGES}
    core = {"calibration", "dynamics", "kinematics", "kinetostatics", "spatial", "trajectory"}
    assert core | {"cartesian"} <= subjects


def test_help_of_inverse_kinematics_begins_with_what_to_give():
    from robomech_ros.kinematics import inverse_kinematics

    text = pydoc.render_doc(inverse_kinematics, renderer=pydoc.plaintext)
    line = text.splitlines()[2].replace("'", "")
    assert line.startswith(
        "inverse_kinematics(chain: SerialChain, T: ArrayLike, *, seed: ArrayLike | None = None, "
        "respect_limits: bool = True"
    )
