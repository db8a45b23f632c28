"""Nodes that `robomech bringup` starts, and their parameters."""

import argparse
import re
from pathlib import Path

import pytest
import yaml

from robomech_ros.cli.kind_options import OptionRefusedError
from robomech_ros.errors import BadValueError, RobomechError, UnknownRobotError
from robomech_ros.nodes.commands import bringup
from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.process import launch_options
from robomech_ros.nodes.process.entry_points import NODE_MODULES
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.nodes.process.nodes_by_kind import KIND_NODES

CONFIG = Path(__file__).resolve().parents[3] / "config"


def parsed(*arguments):
    parser = argparse.ArgumentParser()
    bringup.add_arguments(parser)
    return parser.parse_args(list(arguments))


OF_KINDS = {node for kind in KIND_NODES.values() for node in kind.nodes}
OF_ARMS = (set(NODE_MODULES) - OF_KINDS) | {"joint_trajectory_controller"}


def commands(*arguments):
    return bringup.launch_options(parsed(*arguments)).commands()


def test_every_node_gets_the_robot_and_its_own_file():
    for node, command in commands("--robot", "puma560").items():
        assert command[-2:] == ["-p", 'robot_description:="puma560"']
        assert command[command.index("--params-file") + 1] == str(CONFIG / f"{node}.yaml")


@pytest.mark.parametrize(
    ("ends", "code", "last"),
    [
        ([("rvs", 7), ("servo", -9), None], 0, "servo ended with exit code -9; the other nodes go"),
        ([("rvs", 0), ("kinematics", 0)], 1, "kinematics ended with exit code 0"),
        ([("rvs", 2)], 1, "rvs ended with exit code 2 (its last words"),
    ],
)
def test_a_robot_runs_on_without_the_nodes_that_options_choose(
    monkeypatch, capsys, ends, code, last
):
    class Group:
        def __init__(self, commands):
            self.ends = list(ends)

        def wait_for_end(self):
            return self.ends.pop(0)

        def stop(self):
            return dict(end for end in ends if end) | {"dynamics": 0}

    monkeypatch.setattr(bringup, "ProcessGroup", Group)
    monkeypatch.setattr(bringup, "_on_signals", lambda handler: None)
    assert bringup._supervise({}) == code
    assert last in capsys.readouterr().err.splitlines()[-1]


def test_plans_move_the_robot_only_where_that_is_asked_for():
    given = "auto_execute:=true"
    assert not any(given in command for command in commands("--robot", "scara").values())
    asked = commands("--robot", "scara", "--auto-execute")
    assert [node for node, command in asked.items() if given in command] == ["trajectory_publisher"]


def test_bringup_assumes_limits_unless_it_is_told_otherwise():
    file = str(CONFIG / "trajectory_planner.bringup.yaml")
    every = commands("--robot", "ur5e", "--params-file", "own.yaml")
    assert [node for node, command in every.items() if file in command] == ["trajectory_planner"]
    # What a user gives comes later, and counts.
    planner = every["trajectory_planner"]
    assert planner.index(file) < planner.index("own.yaml")


def test_the_servo_may_be_left_out():
    every, without = set(commands("--robot", "scara")), set(commands("--no-servo"))
    assert every - without == {"servo"} and every == OF_ARMS - {"calibration", "rvs", "move_group"}
    assert set(LaunchOptions("scara", servo=False).commands()) == without


def test_calibration_is_one_of_the_nodes_where_it_is_wanted():
    every = commands("--calibration", "--ros-args", "-p", "tracking_base_frame:=camera")
    assert set(every) == OF_ARMS - {"rvs", "move_group"}
    given = "tracking_base_frame:=camera"
    assert [node for node, command in every.items() if given in command] == ["calibration"]


def test_move_group_is_one_of_the_nodes_where_it_is_wanted(tmp_path):
    file = str(tmp_path / "limits.yaml")
    every = commands("--move-group", "--joint-limits", file)
    assert set(every) == OF_ARMS - {"calibration", "rvs"}
    limited = f'joint_limits:="{file}"'
    found = {node for node, command in every.items() if limited in command}
    assert found == {"trajectory_planner", "move_group"}


def test_the_view_is_one_of_the_nodes_where_it_is_wanted():
    given = ("--view", "--view-port", "0", "--view-host", "0.0.0.0")
    every = commands("--robot", "scara", *given)
    assert list(every)[-1] == "rvs" and set(every) == OF_ARMS - {"calibration", "move_group"}
    for option in ("port:=0", 'host:="0.0.0.0"'):
        assert [node for node, command in every.items() if option in command] == ["rvs"]
    assert not [word for word in commands("--view")["rvs"] if word.startswith(("port:", "host:"))]


def test_parameters_of_one_node_reach_it_in_a_namespace_too():
    """ROS takes -p node:name:=value for nodes without one only: the page's port was 8080."""
    options = bringup.launch_options(
        parsed("--namespace", "left", "--rate", "50", "--ros-args", "-p", "servo:period:=2e-2")
    )
    every = options.commands()
    assert every["joint_trajectory_controller"][-2:] == ["-p", "publish_rate:=50.0"]
    assert every["servo"][-2:] == ["-p", "period:=2e-2"]
    with options.arguments_of_one_process() as arguments:
        path = Path(arguments[-1])
        assert "period: 2e-2\n" in path.read_text("utf-8")
        written = yaml.safe_load(path.read_text("utf-8"))["/**"]
        assert written["joint_trajectory_controller"]["ros__parameters"] == {"publish_rate": 50.0}
    assert not path.exists()


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (("--view-port", "8081"), "--view-port is 8081, expected nothing without --view"),
        (("--view-host", "::1"), "--view-host is '::1', expected nothing without --view"),
        (("--view", "--view-port", "70000"), "--view-port is 70000, expected 0 to 65535"),
    ],
)
def test_options_of_the_view_are_checked(given, text):
    with pytest.raises(BadValueError, match=text):
        bringup.run(parsed("--robot", "puma560", *given))


def test_paths_are_made_absolute(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = ("--namespace", "/left/", "--rate", "50", "--joint-limits", "limits.yaml")
    every = commands("--robot", "arm.urdf", *options)
    for command in every.values():
        assert f'robot_description:="{tmp_path}/arm.urdf"' in command
        assert "__ns:=/left" in command
    assert f'joint_limits:="{tmp_path}/limits.yaml"' in every["trajectory_planner"]


def test_groups_go_to_every_node(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for command in commands("--robot", "ur5e", "--srdf", "a.srdf", "--group", "arm").values():
        assert f'robot_description_semantic:="{tmp_path}/a.srdf"' in command
        assert 'group:="arm"' in command
    assert "semantic" not in str(commands("--robot", "ur5e"))


@pytest.mark.parametrize(
    ("group", "text"),
    [
        ("legs", "group is 'legs', expected one of arm"),
        ("", "line 2: chain: tip_link is 'tool', expected a link"),
    ],
)
def test_an_srdf_that_does_not_fit_is_refused_once(tmp_path, group, text):
    path = tmp_path / "ur5e.srdf"
    tip = "tool0" if group else "tool"
    path.write_text(
        f'<robot name="ur5e"><group name="arm">\n<chain base_link="base_link" tip_link="{tip}"/>'
        "</group></robot>"
    )
    hint = r"( \(did you mean '\w+'\?\))?"
    with pytest.raises(RobomechError, match=text.replace("'tool'", f"'tool'{hint}")):
        bringup.run(parsed("--robot", "ur5e", "--srdf", str(path), "--group", group))


@pytest.mark.parametrize(
    ("given", "prefix"),
    [
        ((), None),
        (("--namespace", "left"), "left/"),
        (("--namespace", "/cell_1/left/"), "cell_1/left/"),
        (("--namespace", "left", "--frame-prefix", ""), None),
        (("--namespace", "left", "--frame-prefix", "l_"), "l_"),
        (("--frame-prefix", "l_"), "l_"),
    ],
)
def test_frames_of_a_namespace_have_its_name_in_front(given, prefix):
    for command in commands("--robot", "ur5e", *given).values():
        found = [word for word in command if word.startswith("frame_prefix:=")]
        assert found == ([f'frame_prefix:="{prefix}"'] if prefix else [])


def test_ros_arguments_go_to_every_node():
    given = ("-r", "/tf:=tf", "-p", "use_sim_time:=true", "--log-level", "debug")
    for command in commands("--robot", "ur5e", "--ros-args", *given).values():
        assert command[-len(given) :] == [*given]
        assert command.count("--ros-args") == 1


def test_a_parameter_goes_to_the_nodes_that_have_it():
    """Every other node warned of it."""
    given = ("-p", "publish_frames:=never", "--param", "state_timeout:=2.0", "-p", "no:=1")
    every = commands("--ros-args", *given)
    assert all("no:=1" in words for words in every.values())
    for parameter, owners in (
        ("publish_frames:=never", {"joint_trajectory_controller"}),
        ("state_timeout:=2.0", {"kinematics", "dynamics", "trajectory_planner"}),
    ):
        assert {node for node, words in every.items() if parameter in words} == owners


@pytest.mark.parametrize("node", sorted(NODE_MODULES))
def test_the_parameters_of_a_node_are_those_of_its_table(node):
    names = {row.name for row in table_rows(bringup.node_class(node).SETTINGS)}
    assert launch_options._parameter_names(node) == names


def test_launch_may_append_nothing():
    assert commands("--robot", "ur5e", "--ros-args") == commands("--robot", "ur5e")


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (
            ("-r", "/tf"),
            "--ros-args is '-r /tf', expected arguments as `ros2 run` takes them .*/tf",
        ),
        (("--remap-it", "a:=b"), "--ros-args is '--remap-it a:=b', expected arguments as"),
        (("-r", "__node:=arm"), "--ros-args is '-r __node:=arm', expected no name, which all"),
    ],
)
def test_wrong_ros_arguments_are_refused_once(given, text):
    with pytest.raises(BadValueError, match=text):
        bringup.run(parsed("--robot", "puma560", "--ros-args", *given))


def test_drives_may_move_the_robot():
    given = "simulation:=dynamic"
    assert given in commands("--robot", "ur5e", "--dynamic")["joint_trajectory_controller"]
    of_demonstration = LaunchOptions("ur5e", dynamic=True, servo=False).commands()
    assert given in of_demonstration["joint_trajectory_controller"]
    assert given not in commands("--robot", "ur5e")["joint_trajectory_controller"]


def test_without_a_robot_the_nodes_wait_for_the_topic():
    assert not [word for word in commands()["kinematics"] if "robot_description" in word]


@pytest.mark.parametrize(
    ("option", "value"),
    [("--params-file", "/no/such.yaml"), ("--namespace", "bad name"), ("--frame-prefix", "/left")],
)
def test_what_no_node_could_use_is_refused_once(option, value):
    with pytest.raises(BadValueError, match=f"{option} is '{value}', expected "):
        bringup.run(parsed("--robot", "puma560", option, value))


def test_a_rolling_robot_has_the_mobile_base_alone():
    every = commands("--robot", "mecanum", "--dynamic", "--rate", "20", "--frame-prefix", "left")
    assert set(every) == {"mobile_base"}
    words = every["mobile_base"]
    for option in (
        'robot_description:="mecanum"',
        'tf_frame_prefix:="left"',
        "simulation:=dynamic",
        "publish_rate:=20.0",
    ):
        assert option in words
    with pytest.raises(OptionRefusedError, match="--group does not apply to 'mecanum'"):
        bringup.run(parsed("--robot", "mecanum", "--group", "arm"))


def test_a_hand_has_the_node_grasping_alone():
    every = commands("--robot", "three_fingered", "--frame-prefix", "left/")
    assert set(every) == {"grasping"}
    for option in ('robot_description:="three_fingered"', 'frame_prefix:="left/"'):
        assert option in every["grasping"]
    for option in ("--dynamic", "--calibration", "--view"):
        said = f"{option} does not apply to 'three_fingered', a hand; what applies: --localhost, "
        with pytest.raises(OptionRefusedError, match=said):
            bringup.run(parsed("--robot", "three_fingered", option))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--group", "arm"), "--group does not apply to 'delta', a parallel robot; what applies: "),
        (("--tip-link", "x"), "tip_link is 'x', expected 'platform' or empty"),
    ],
)
def test_options_of_arms_are_refused_once_for_a_parallel_robot(options, said):
    with pytest.raises(RobomechError, match=said):
        bringup.run(parsed("--robot", "delta", *options))


@pytest.mark.parametrize("name", ["hexapodd", "mecanun", "phantomy", "three_finger", "puma561"])
def test_a_misspelt_robot_is_looked_for_among_all_kinds(name):
    nearest = {"hexapodd": "hexapod", "mecanun": "mecanum", "phantomy": "phantomx"}
    wanted = nearest.get(name) or {"three_finger": "three_fingered"}.get(name, "puma560")
    with pytest.raises(UnknownRobotError, match=f"did you mean '{wanted}'") as caught:
        bringup.run(parsed("--robot", name))
    assert caught.value.available[0] == wanted
    assert {"ur5e", "delta", "omni", "go1", "three_fingered"} <= set(caught.value.available)


def test_a_walking_machine_has_the_walker_and_its_controller():
    every = commands("--robot", "phantomx", "--rate", "50", "--namespace", "left")
    assert list(every) == ["joint_trajectory_controller", "walker"]
    for words in every.values():
        assert {'robot_description:="phantomx"', 'frame_prefix:="left/"'} <= set(words)
    assert "publish_rate:=50.0" in every["joint_trajectory_controller"]
    assert "publish_rate:=50.0" not in every["walker"]
    for option in (["--group", "arm"], ["--dynamic"]):
        with pytest.raises(OptionRefusedError, match="'phantomx', a walking machine"):
            bringup.run(parsed("--robot", "phantomx", *option))
    viewed = commands("--robot", "phantomx", "--view", "--namespace", "left")
    assert list(viewed) == ["joint_trajectory_controller", "walker", "rvs"]
    for words in viewed.values():
        assert {'robot_description:="phantomx"', 'frame_prefix:="left/"'} <= set(words)


def test_the_view_of_a_rolling_robot_gets_no_parameter_of_another_node():
    every = commands("--robot", "mecanum", "--view", "--namespace", "left", "--view-port", "0")
    assert list(every) == ["mobile_base", "rvs"]
    assert 'tf_frame_prefix:="left/"' in every["mobile_base"]
    assert not [word for word in every["rvs"] if "frame_prefix" in word]
    assert {'robot_description:="mecanum"', "port:=0"} <= set(every["rvs"])


@pytest.mark.parametrize("node", NODE_MODULES)
def test_file_of_each_node_gives_the_defaults_of_its_table(node):
    values = yaml.safe_load((CONFIG / f"{node}.yaml").read_text(encoding="utf-8"))
    given = values["/**"][node]["ros__parameters"]
    rows = {row.name: row for row in table_rows(bringup.node_class(node).SETTINGS)}
    assert given.keys() <= rows.keys()
    for name, value in given.items():
        assert (tuple(value) if isinstance(value, list) else value) == rows[name].default, name


def documented(node):
    """Return the parameters of a node in the documentation.

    Name to default, and whether it is *.
    """
    page = (CONFIG.parent / "doc" / "interfaces.md").read_text(encoding="utf-8")
    parts = re.split(r"^(Of all nodes|`\w+`)(?=[: ])", page, flags=re.MULTILINE)
    tables = dict(zip(parts[1::2], parts[2::2], strict=True))
    alone = ("mobile_base", "grasping", "walker")
    of_all = "" if node in alone else tables["Of all nodes"]
    listed = of_all + tables[f"`{node}`"].split("## ")[0]
    rows = re.findall(r"^\| `([\w.]+)`( \*)? \| (.*?) \|", listed, re.MULTILINE)
    return {name: (default.strip("`"), bool(star)) for name, star, default in rows}


@pytest.mark.parametrize("node", NODE_MODULES)
def test_every_parameter_is_documented_with_its_default(node):
    shown = {"''": '""', "True": "true", "False": "false", "()": "empty"}
    expected = {}
    for row in table_rows(bringup.node_class(node).SETTINGS):
        unit = f" {row.unit}" if row.unit in ("s", "Hz") else ""
        value = list(row.default) if row.default and type(row.default) is tuple else row.default
        default = shown.get(repr(value), str(value))
        expected[row.name] = (default + unit, not row.read_only)
    assert documented(node) == expected


@pytest.mark.parametrize("node", NODE_MODULES)
def test_every_node_is_found_and_has_its_name(node, graph):
    more = {"port": 0} if node == "rvs" else {}
    robots = {"mobile_base": "mecanum", "grasping": "three_fingered", "walker": "phantomx"}
    robot = robots.get(node, "scara")
    started = graph.start(bringup.node_class(node), robot_description=robot, **more)
    assert started.get_name() == node
