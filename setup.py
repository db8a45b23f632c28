"""Packaging of robomech_ros for pip and colcon (ament_python)."""

import re
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "robomech_ros"
EXECUTABLES = (
    "kinematics_node",
    "dynamics_node",
    "trajectory_planner_node",
    "trajectory_publisher_node",
    "joint_state_simulator_node",
    "move_group_node",
    "servo_node",
    "calibration_node",
    "rvs_node",
    "mobile_base_node",
    "grasping_node",
    "walker_node",
)
HERE = Path(__file__).resolve().parent
VERSION = re.search(
    r'__version__ = "(.+)"', (HERE / PACKAGE / "__init__.py").read_text(encoding="utf-8")
).group(1)


def requirements(name):
    """Return the lines of a requirements file without comments."""
    lines = (HERE / "requirements" / name).read_text(encoding="utf-8").splitlines()
    return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def shared_files():
    """Return data_files that install config/ below share/robomech_ros, folder by folder."""
    folders = [HERE / "config", *sorted(p for p in (HERE / "config").rglob("*") if p.is_dir())]
    for folder in folders:
        if not folder.is_dir():
            continue
        place = folder.relative_to(HERE)
        files = sorted(str(place / p.name) for p in folder.iterdir() if p.is_file())
        if files:
            yield f"share/{PACKAGE}/{place.as_posix()}", files


setup(
    name=PACKAGE,
    version=VERSION,
    description="Kinematics, trajectories and simulated control of any robot arm, for ROS 2",
    long_description=(HERE / "README.md").read_text(encoding="utf-8")
    if (HERE / "README.md").is_file()
    else "",
    long_description_content_type="text/markdown",
    url="https://github.com/robomech/robomech_ros",
    author="robomech_ros contributors",
    maintainer="robomech_ros maintainers",
    maintainer_email="maintainers@robomech.example",
    license="Apache-2.0",
    packages=find_packages(include=[PACKAGE, f"{PACKAGE}.*"]),
    package_data={PACKAGE: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        *shared_files(),
    ],
    python_requires=">=3.10",
    install_requires=requirements("core.in"),
    extras_require={
        "collision": requirements("collision.in"),
        "dask": requirements("dask.in"),
        "hands": requirements("hands.in"),
        "symbolic": ["sympy"],
        "view": requirements("view.in"),
    },
    zip_safe=False,
    entry_points={
        "console_scripts": [
            *(f"{name} = {PACKAGE}.nodes.process.entry_points:{name}" for name in EXECUTABLES),
            "robomech = robomech_ros.cli.main:main",
        ]
    },
)
