"""The README, the table of what nodes serve, and the table of questions; no ROS needed."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parent.parent
DOC = ROOT / "doc"
README = (ROOT / "README.md").read_text(encoding="utf-8")
SERVED = (DOC / "nodes.md").read_text(encoding="utf-8")
QUESTIONS = (DOC / "questions.md").read_text(encoding="utf-8")
NODES = sorted((ROOT / "robomech_ros" / "nodes").rglob("*.py"))
INTERFACES = ROOT / "robomech_interfaces"
FIELD = re.compile(r"^[A-Za-z][\w/]*(?:\[\d*\])?\s+([a-z]\w*)$")
FOREIGN = {
    "geometry_msgs/msg/PolygonStamped",
    "geometry_msgs/msg/Pose",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TwistStamped",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/MultiDOFJointState",
    "control_msgs/action/FollowJointTrajectory",
    "control_msgs/srv/QueryTrajectoryState",
    "nav_msgs/msg/Odometry",
    "std_msgs/msg/Float64",
    "std_msgs/msg/Float64MultiArray",
    "std_msgs/msg/String",
    "std_srvs/srv/Empty",
    "std_srvs/srv/SetBool",
    "std_srvs/srv/Trigger",
    "visualization_msgs/msg/MarkerArray",
    "tf2_msgs/msg/TFMessage",
    "trajectory_msgs/msg/JointTrajectory",
}


def section(heading: str) -> str:
    """Return the text under a heading of the second level."""
    return README.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0]


def served() -> list[tuple[list[str], str]]:
    """Return the names and the type of each row of the table of what nodes serve."""
    rows = [line for line in SERVED.splitlines() if line.startswith("|")][2:]
    cells = [row.strip("|").split("|") for row in rows]
    quoted = [[re.findall(r"`([^`]+)`", cell) for cell in row] for row in cells]
    return [(row[1], row[2][0]) for row in quoted]


def blocks(language: str) -> list[str]:
    """Return the fenced blocks of a language under "Ask for all solutions"."""
    pattern = rf"^```{language}\n(.*?)^```"
    return re.findall(pattern, section("Ask for all solutions"), re.DOTALL | re.MULTILINE)


def fields(name: str) -> tuple[list[str], list[str]]:
    """Return the names of the fields of request and response of a service."""
    text = (INTERFACES / "srv" / f"{name}.srv").read_text(encoding="utf-8")
    request, response = text.split("\n---\n")
    lines = [[line.split("#")[0].strip() for line in x.splitlines()] for x in (request, response)]
    found = [[match[1] for line in part if (match := FIELD.match(line))] for part in lines]
    return found[0], found[1]


def test_types_in_the_table_are_defined():
    for _, kind in served():
        ending = kind.split("/")[-2]
        known = [INTERFACES / f"{kind}.{ending}", ROOT / "compat" / f"{kind}.{ending}"]
        assert kind in FOREIGN or any(path.is_file() for path in known), kind


def test_what_the_table_names_is_in_the_nodes():
    source = "\n".join(path.read_text(encoding="utf-8") for path in NODES)
    offered = set(re.findall(r'"(?:~?/)?([a-z_]+)"', source))
    for names, _ in served():
        assert {name.removeprefix("~").removeprefix("/") for name in names} <= offered, names


def test_every_service_of_the_nodes_is_in_the_table():
    source = "\n".join(path.read_text(encoding="utf-8") for path in NODES)
    offered = set(re.findall(r'\bserve\(\s*\w+,\s*(\w+),\s*"~/(\w+)"', source))
    assert offered
    named = {(kind.split("/")[-1], n.removeprefix("~/")) for names, kind in served() for n in names}
    assert offered <= named, f"served and not listed: {sorted(offered - named)}"


def test_calls_name_the_service_and_fields_that_exist():
    (with_ros2,) = blocks("sh")
    (with_ours,) = blocks("console")
    one = re.fullmatch(r'ros2 service call (\S+) (\S+) \\\n  "(.*)"\n', with_ros2)
    other = re.match(r'\$ robomech call (\S+) \\\n  "(.*)"\n', with_ours)
    assert one and other
    assert one[2] == "robomech_interfaces/srv/SolveIK"
    assert one[1] == f"/{other[1]}"
    assert yaml.safe_load(one[3]) == yaml.safe_load(other[2])
    assert set(yaml.safe_load(one[3])) <= set(fields("SolveIK")[0])


def test_the_answer_shows_all_fields_of_the_response():
    (console,) = blocks("console")
    shown = yaml.safe_load(console.split('"\n', 1)[1])
    assert list(shown) == fields("SolveIK")[1]
    assert shown["error_code"] == 0
    assert len(shown["solutions"]) == len(shown["branches"]) > 1


def targets(text: str) -> set[str]:
    """Return the files that a page links to."""
    found = {target.split("#")[0] for target in re.findall(r"\]\(([^)]+)\)", text)}
    return {target for target in found if target and not target.startswith("http")}


def test_every_page_is_in_the_table_of_questions_and_links_of_the_readme_lead_somewhere():
    pages = {path.name for path in DOC.iterdir() if path.suffix in (".md", ".rst")}
    assert targets(QUESTIONS) == pages - {"index.md", "questions.md"} | {"notebooks/index.md"}
    for target in targets(README):
        assert (ROOT / target).is_file(), target


def test_the_readme_begins_with_one_screen():
    above, _ = README.split("\n|", 1)
    assert len(above.splitlines()) <= 30
    commands = re.findall(r"^```sh\n(.*?)^```", above, re.DOTALL | re.MULTILINE)[0].splitlines()
    assert len(commands) == 2
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for command in commands:
        assert f"\n{command.split()[1]}:" in makefile
    (picture,) = re.findall(r"!\[[^]]+\]\(([^)]+)\)", above)
    data = (ROOT / picture).read_bytes()
    assert data.startswith(b"GIF89a")
    assert b"NETSCAPE2.0" in data  # it moves, again and again
    assert len(data) <= 1_000_000


@pytest.mark.parametrize(
    ("question", "found"),
    [
        ("3-4-5 polynomial", "trajectory.Polynomial345"),
        ("natural orthogonal complement", "dynamics.natural_orthogonal_complement"),
        ("characteristic length", 'characteristic_length(load_robot("fanuc_arcmate"))'),
        ("where a SolveIK request goes", "inverse_kinematics.py"),
    ],
)
def test_a_question_leads_to_a_page_with_the_answer(question, found):
    (row,) = [line for line in QUESTIONS.splitlines() if question in line]
    pages = [(DOC / page).read_text("utf-8") for page in re.findall(r"\]\(([^)#]+)", row)]
    answers = [page for page in pages if found in page]
    assert answers
    assert question.removeprefix("where a ").lower() in answers[0].lower()
