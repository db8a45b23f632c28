"""``robomech doctor``: what is missing on this machine, and the command that installs it."""

import argparse
import importlib.util
import os
import shutil
import socket
import sys
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from robomech_ros.fastdds_shared_memory import dead_ports, ports_of_domain

OLDEST_PYTHON = (3, 10)
MULTICAST_GROUP = "239.255.0.1"
SET_UP = "make setup"
# Above this the ports of some participants leave the range that UDP has.
LARGEST_DOMAIN = 232
# Up to this Linux gives the ports, but for those of many participants, to nobody else.
SAFE_DOMAIN = 101


class Finding(NamedTuple):
    """The result of one check."""

    #: Name of the checked thing.
    what: str
    #: Whether it meets the requirement; None if it is optional and missing.
    ok: bool | None
    #: The finding as text.
    found: str
    #: Command or advice; empty if nothing needs mending.
    mend: str = ""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""


def run(args: argparse.Namespace) -> int:
    """Print the findings; returns 0 if nothing that is needed is missing, else 1."""
    marks = {True: "ok", False: "MISSING", None: "-"}
    good = True
    for finding in findings():
        print(f"{marks[finding.ok]:8} {finding.what:22} {finding.found}")
        if finding.mend:
            print(f"{'':8} {'':22} -> {finding.mend}")
        good = good and finding.ok is not False
    print("nothing is missing" if good else "the suite cannot work without what is MISSING")
    return 0 if good else 1


def findings() -> Iterator[Finding]:
    """Look at everything the suite needs."""
    yield _python()
    yield _compiler()
    yield _module("rclpy", "ROS 2 client library", "ros-rclpy")
    yield _middleware()
    yield _module("robomech_interfaces.srv", "our interfaces", "ros-robomech-interfaces")
    yield _module("numba", "numba", "numba")
    yield _module("ruckig", "ruckig", "ruckig")
    yield _kernels()
    yield _robots()
    yield _node_scripts()
    yield _loopback()
    yield _multicast()
    yield _shared_memory()
    yield _domain()
    yield _sourced()
    yield _optional("matplotlib", "plots of robomech demo")
    yield _optional("clarabel", "contact_forces of hands")
    extra = "pip install 'robomech_ros[collision]'"
    yield _optional("coal", "collision checks, move_group", extra)
    yield _optional("ompl", "planning around obstacles, move_group", extra)
    yield _optional("viser", "robomech view, and the page of robomech demo")
    yield _optional(
        "control_msgs",
        "follow_joint_trajectory, controller_state, query_state, gripper_cmd of the simulated "
        "robot; driving ros2_control; JointJog for the servo",
    )
    yield _optional(
        "moveit_msgs",
        "compute_ik, compute_fk, compute_cartesian_path and more services of MoveIt; "
        "switch_command_type and MoveIt's status of the servo",
    )
    yield _optional("tf2_msgs", "/tf and /tf_static of the simulated robot")


def _python() -> Finding:
    found = f"{sys.version.split()[0]} ({sys.executable})"
    ok = sys.version_info[:2] >= OLDEST_PYTHON
    return Finding("python", ok, found, "" if ok else "make setup PYTHON=python3.10 (or newer)")


def _compiler() -> Finding:
    name = os.environ.get("CXX") or next(filter(shutil.which, ("c++", "g++", "clang++")), "")
    if name:
        return Finding("C++ compiler", True, shutil.which(name.split()[0]) or name)
    built = importlib.util.find_spec("robomech_interfaces") is not None
    found = "none; only needed to build the interfaces" + (", which are built" if built else "")
    return Finding("C++ compiler", None if built else False, found, "sudo apt-get install g++")


def _module(name: str, what: str, distribution: str) -> Finding:
    try:
        module = import_module(name)
    except ImportError as error:
        return Finding(what, False, str(error), SET_UP)
    try:
        found = version(distribution)
    except PackageNotFoundError:
        found = str(Path(module.__file__ or "").parent)
    return Finding(what, True, found)


def _optional(name: str, purpose: str, remedy: str = "") -> Finding:
    there = importlib.util.find_spec(name) is not None
    if there:
        return Finding(name, True, purpose)
    return Finding(name, None, f"not installed: {purpose}", remedy)


def _middleware() -> Finding:
    try:
        from rclpy.utilities import get_rmw_implementation_identifier

        return Finding("middleware", True, str(get_rmw_implementation_identifier()))
    except ImportError as error:
        mend = "unset RMW_IMPLEMENTATION" if os.environ.get("RMW_IMPLEMENTATION") else SET_UP
        return Finding("middleware", False, " ".join(str(error).split()), mend)


def _kernels() -> Finding:
    what = "compiled kernels"
    try:
        from robomech_ros._kernels.compiling.cache import cache_directory
    except ImportError as error:
        return Finding(what, False, str(error), SET_UP)
    place = cache_directory()
    if place is None:
        mend = "export ROBOMECH_CACHE_DIR=<a folder that you alone can write>"
        return Finding(what, False, "no place to keep them that you alone can write", mend)
    if not any(place.glob("*.nbi")):
        return Finding(what, False, f"none in {place}: the first start takes a minute",
                       "robomech warmup")  # fmt: skip
    return Finding(what, True, str(place))


def _robots() -> Finding:
    from robomech_ros.robots import list_robots, robot_folders
    from robomech_ros.robots.robot_kinds import KINDS, documents_of

    names = list_robots()
    folders = ", ".join(str(folder) for folder in robot_folders())
    if names:
        others = ", ".join(f"{kind} {len(documents_of(kind))}" for kind in KINDS)
        return Finding("robots", True, f"arms {len(names)}, {others} in {folders}")
    return Finding("robots", False, f"none in {folders or 'any folder'}", SET_UP)


def _node_scripts() -> Finding:
    beside = Path(sys.executable).parent
    place = shutil.which("kinematics_node", path=str(beside)) or shutil.which("kinematics_node")
    if place:
        return Finding("node executables", True, str(Path(place).parent))
    return Finding("node executables", False, f"kinematics_node is not in {beside}", SET_UP)


def _loopback() -> Finding:
    if (wrong := _lost_datagram()) is not None:
        return Finding("loopback", False, str(wrong), "sudo ip link set lo up")
    return Finding("loopback", True, "datagrams arrive")


def _multicast() -> Finding:
    """Check the group that DDS uses for discovery."""
    what = "multicast discovery"
    if (wrong := _lost_datagram(MULTICAST_GROUP)) is not None:
        found = f"does not arrive ({wrong}); nodes on this machine find each other without it"
        return Finding(what, None, found, "sudo ip link set lo multicast on")
    return Finding(what, True, "datagrams arrive")


def _lost_datagram(group: str = "") -> OSError | None:
    """Send a datagram over the loopback interface, to a group if given; return why it is lost."""
    here = "127.0.0.1"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as inbox:
        try:
            inbox.settimeout(1.0)
            inbox.bind(("" if group else here, 0))
            if group:
                local, joined = map(socket.inet_aton, (here, group))
                inbox.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joined + local)
                inbox.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, local)
            inbox.sendto(b"robomech", (group or here, inbox.getsockname()[1]))
            inbox.recv(16)
        except OSError as error:
            return error
    return None


def _shared_memory() -> Finding:
    if left := dead_ports():
        ports = ", ".join(map(str, left))
        found = f"killed processes left ports of Fast DDS, on which messages may be lost: {ports}"
        mend = "fastdds shm clean; without that tool, end all nodes and rm /dev/shm/*fastdds*"
        return Finding("shared memory", None, found, mend)
    return Finding("shared memory", True, "no ports left of killed processes")


def _domain() -> Finding:
    what = "ROS domain"
    text = os.environ.get("ROS_DOMAIN_ID", "")
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET (default)")
    if text and not (
        text.isascii() and text.isdecimal() and len(text) < 10 and int(text) <= LARGEST_DOMAIN
    ):
        return Finding(what, False, repr(text), f"export ROS_DOMAIN_ID=<0 to {SAFE_DOMAIN}>")
    domain, found = int(text or 0), f"{text or '0 (default)'}, discovery range {reach}"
    ports, given = ports_of_domain(domain), _ports_given_away()
    if domain > SAFE_DOMAIN and ports.start < given.stop and given.start < ports.stop:
        found += f"; the system gives its ports to others, too ({given.start} to {given.stop - 1})"
        return Finding(what, None, found, f"export ROS_DOMAIN_ID=<0 to {SAFE_DOMAIN}>")
    return Finding(what, True, found)


def _ports_given_away() -> range:
    """Return the range of ports that the system assigns."""
    try:
        first, last = map(int, Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split())
    except (OSError, ValueError):
        return range(32768, 61000)
    return range(first, last + 1)


def _sourced() -> Finding:
    """Say which ROS distribution is in the shell, and whether it is the one we run on."""
    what = "sourced distribution"
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    foreign = [p for p in prefixes if not Path(p).resolve().is_relative_to(sys.prefix)]
    if not foreign:
        return Finding(what, True, "none, the environment's own ROS is used")
    spec = importlib.util.find_spec("rclpy")
    origin = Path(spec.origin).resolve() if spec and spec.origin else Path()
    found = f"{os.environ.get('ROS_DISTRO', 'unknown')} in {foreign[0]}; rclpy from {origin.parent}"
    mixed = origin.is_relative_to(sys.prefix) and bool(os.environ.get("LD_LIBRARY_PATH"))
    mend = "start from a shell without it, or build with colcon build and use it alone"
    return Finding(what, None if mixed else True, found, mend if mixed else "")
