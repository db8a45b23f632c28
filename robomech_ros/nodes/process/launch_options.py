"""Options for all nodes of a robot, and the command line of each."""

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import yaml

from robomech_ros.nodes.process.entry_points import NODE_MODULES
from robomech_ros.nodes.process.nodes_by_kind import KIND_NODES
from robomech_ros.nodes.process.process_group import node_command
from robomech_ros.robots import robot_folders

# Options choose these nodes; a robot runs on when one of them ends.
OPTIONAL_NODES = ("servo", "calibration", "rvs", "move_group")

# Options that precede a parameter.
_PARAMETER = ("-p", "--param")
# Simulator of arms and parallel robots.
_SIMULATOR = "joint_trajectory_controller"


@dataclass(frozen=True)
class LaunchOptions:
    """Options of `robomech bringup`; every node gets the same ROS arguments from them.

    Fields have the names and the meaning of the options.  Empty, or None, is an option that is not
    given; `servo` is the opposite of ``--no-servo``, and `kind` that of a robot that is no arm, by
    ``KIND_NODES``.
    """

    robot: str = ""
    base_link: str = ""
    tip_link: str = ""
    srdf: str = ""
    group: str = ""
    namespace: str = ""
    frame_prefix: str | None = None
    rate: float | None = None
    joint_limits: str = ""
    dynamic: bool = False
    params_files: tuple[str, ...] = ()
    auto_execute: bool = False
    servo: bool = True
    calibration: bool = False
    move_group: bool = False
    view: bool = False
    view_port: int | None = None
    view_host: str | None = None
    kind: str = ""
    ros_args: tuple[str, ...] = ()

    @property
    def nodes(self) -> tuple[str, ...]:
        """Names of the nodes, in the order in which they are started."""
        own = KIND_NODES.get(self.kind)
        if own is not None:
            return (*own.nodes, "rvs") if self.view else own.nodes
        chosen = (self.servo, self.calibration, self.view, self.move_group)
        optional = dict(zip(OPTIONAL_NODES, chosen, strict=True))
        others = {node for kind in KIND_NODES.values() for node in kind.nodes} - {_SIMULATOR}
        return tuple(node for node in NODE_MODULES if optional.get(node, node not in others))

    def commands(self) -> dict[str, list[str]]:
        """Return the command line of each node's process."""
        shared, own = _apart(self.ros_arguments())
        return {
            node: node_command(node, [*shipped, *shared, *_given(own.get(node, {}))])
            for node, shipped in self._shipped().items()
        }

    @contextmanager
    def arguments_of_one_process(self) -> Iterator[list[str]]:
        """Yield the ROS arguments for all nodes in one process, as long as it needs them."""
        files = [argument for shipped in self._shipped().values() for argument in shipped]
        shared, own = _apart(self.ros_arguments())
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "parameters.yaml"
            values = {node: {"ros__parameters": its} for node, its in own.items()}
            path.write_text(yaml.serialize(_document({"/**": values})), encoding="utf-8")
            last = ["--params-file", str(path)] if own else []
            yield ["--ros-args", *files, *shared, *last]

    def ros_arguments(self) -> list[str]:
        """Turn the options into ROS arguments; parameters of one node have its name in front."""
        result = [word for name in self.params_files for word in ("--params-file", name)]
        if self.namespace:
            result += ["-r", f"__ns:=/{self.namespace.strip('/')}"]
        own = KIND_NODES.get(self.kind)
        if own is None:
            simulated = _SIMULATOR
            texts = {
                "base_link": self.base_link,
                "tip_link": self.tip_link,
                "robot_description_semantic": _absolute(self.srdf),
                "group": self.group,
                "frame_prefix": self._frame_prefix(),
            }
        else:
            simulated, texts = own.simulator, self._prefixes(own.frame_prefix)
        texts = {"robot_description": self._robot()} | texts
        texts["trajectory_planner:joint_limits"] = _absolute(self.joint_limits)
        if self.move_group:
            texts["move_group:joint_limits"] = _absolute(self.joint_limits)
        # Quoted: YAML would read a robot called 7 as a number.
        words = {name: json.dumps(text) for name, text in texts.items() if text}
        if self.rate is not None:
            words[f"{simulated}:publish_rate"] = f"{float(self.rate)}"
        if self.dynamic:
            words[f"{simulated}:simulation"] = "dynamic"
        if self.auto_execute:
            words["trajectory_publisher:auto_execute"] = "true"
        if self.view and self.view_port is not None:
            words["rvs:port"] = f"{self.view_port}"
        if self.view and self.view_host is not None:
            words["rvs:host"] = json.dumps(self.view_host)
        result += _given(words)
        return [*result, *self._addressed()]

    def _shipped(self) -> dict[str, list[str]]:
        """Put first the ROS arguments for each node's parameter files, for all else to override."""
        own = KIND_NODES.get(self.kind)
        variant = own.variant(self._robot()) if own and own.variant and self.robot else ""
        return {
            node: [
                *config_file(node),
                *config_file(f"{node}.bringup"),
                *(config_file(f"{node}.{variant}") if variant else ()),
            ]
            for node in self.nodes
        }

    def _prefixes(self, name: str) -> dict[str, str]:
        """Return the prefix of frames by the parameter of those nodes that have it."""
        owners = [node for node in self.nodes if name in _parameter_names(node)]
        every = len(owners) == len(self.nodes)
        names = [name] if every else [f"{node}:{name}" for node in owners]
        return dict.fromkeys(names, self._frame_prefix())

    def _addressed(self) -> list[str]:
        """Return the other arguments, with parameters addressed to the nodes that have them.

        The other nodes would warn of each.  What none has, such as use_sim_time, goes to all.
        """
        result, words = list[str](), iter(self.ros_args)
        for word in words:
            value = next(words, None) if word in _PARAMETER else None
            if value is None:
                result.append(word)
                continue
            name, assigned, rest = value.partition(":=")
            owners = [node for node in self.nodes if name in _parameter_names(node)]
            if not assigned or len(owners) in (0, len(self.nodes)):
                result += [word, value]
            for node in owners if len(owners) < len(self.nodes) else ():
                result += [word, f"{node}:{name}:={rest}"]
        return result

    def _frame_prefix(self) -> str:
        if self.frame_prefix is not None:
            return self.frame_prefix
        return f"{self.namespace.strip('/')}/" if self.namespace.strip("/") else ""

    def _robot(self) -> str:
        is_path = bool(Path(self.robot).suffix) or "/" in self.robot
        return _absolute(self.robot) if is_path else self.robot


def _apart(arguments: Sequence[str]) -> tuple[list[str], dict[str, dict[str, str]]]:
    """Part arguments for every node from the parameters, by name, of each node alone.

    ROS takes `-p node:name:=value` for a node without a namespace only.
    """
    shared, own = list[str](), dict[str, dict[str, str]]()
    words = iter(arguments)
    for word in words:
        value = next(words, None) if word in _PARAMETER else None
        node, _, assignment = (value or "").partition(":")
        name, assigned, text = assignment.partition(":=")
        if node in NODE_MODULES and assigned:
            own.setdefault(node, {})[name] = text
        else:
            shared += [word] if value is None else [word, value]
    return shared, own


def _given(parameters: dict[str, str]) -> list[str]:
    """Turn parameters into ROS arguments."""
    return [word for name, text in parameters.items() for word in ("-p", f"{name}:={text}")]


def _document(tree: Mapping[str, Any] | str) -> yaml.Node:
    """Make a YAML document of texts as they are: `1e-3` is a number to ROS, none to YAML 1.1."""
    if isinstance(tree, str):
        return yaml.compose(tree, yaml.SafeLoader) or yaml.ScalarNode("tag:yaml.org,2002:null", "")
    rows = [(yaml.ScalarNode("tag:yaml.org,2002:str", k), _document(v)) for k, v in tree.items()]
    return yaml.MappingNode("tag:yaml.org,2002:map", rows)


def _parameter_names(node: str) -> set[str]:
    from robomech_ros.nodes.common.parameters import table_rows

    settings = NODE_MODULES[node].rpartition(".")[0] + ".settings"
    module = import_module(settings)
    tables = [
        value
        for value in vars(module).values()
        if getattr(value, "__module__", "") == settings
        and isinstance(value, type)
        and is_dataclass(value)
    ]
    return {row.name for row in table_rows(tables[0])}


def config_file(name: str) -> list[str]:
    """Return the ROS arguments for parameters that the package ships, for a node or a variant."""
    for folder in robot_folders():
        path = folder.parent / f"{name}.yaml"
        if path.is_file():
            return ["--params-file", str(path)]
    return []


def _absolute(path: str) -> str:
    """Return the absolute path; empty for none."""
    return str(Path(path).expanduser().resolve()) if path else ""
