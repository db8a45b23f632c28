"""Discovery range of the nodes: this machine, or the whole subnet; obstacles to it."""

import os
from collections.abc import Mapping

from robomech_ros.fastdds_shared_memory import PORTS_OF_ALL_DOMAINS, dead_ports, ports_of_domain

_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_WHO = {
    "SUBNET": "every machine of the subnet",
    "LOCALHOST": "this machine",
    "OFF": "nobody: no discovery",
    "SYSTEM_DEFAULT": "as configured in the middleware",
}


def stay_on_this_machine() -> None:
    """Restrict discovery to this machine for nodes that start later, and in child processes."""
    os.environ[_RANGE] = "LOCALHOST"
    # It was there before, and goes before the range while it is set.
    os.environ.pop("ROS_LOCALHOST_ONLY", None)


def reach(environment: Mapping[str, str]) -> str:
    """Say in words which domain nodes are in, and from where they can be reached."""
    chosen = environment.get(_RANGE, "").upper() or "SUBNET"
    if environment.get("ROS_LOCALHOST_ONLY", "0") == "1":
        chosen = "LOCALHOST"
    domain = environment.get("ROS_DOMAIN_ID", "") or "0"
    return f"domain {domain}, reached from {_WHO.get(chosen, _WHO['SUBNET'])}"


def ports_left(environment: Mapping[str, str]) -> str:
    """Say which ports that the nodes may get killed processes have left; empty for none."""
    domain = environment.get("ROS_DOMAIN_ID", "") or "0"
    own = ports_of_domain(int(domain)) if domain.isdecimal() and len(domain) < 10 else range(0)
    left = [str(port) for port in dead_ports([*PORTS_OF_ALL_DOMAINS, *own])]
    if not left:
        return ""
    ports = ", ".join(left)
    return f"killed processes left ports of Fast DDS, on which messages may be lost: {ports}"
