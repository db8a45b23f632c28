"""Kind of a robot by its name, its file or its text."""

import pytest

from robomech_ros.errors import RobotDescriptionError, UnknownRobotError
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import list_robots, load_robot
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, documents_of, kind_of

EVERY = [(kind, name) for kind in KINDS for name in documents_of(kind)]


@pytest.mark.parametrize(("kind", "name"), EVERY)
def test_a_robot_is_of_its_kind_by_name_path_and_text(kind, name):
    path = documents_of(kind)[name]
    for given in (name, f" {name} ", path, str(path), path.read_text(encoding="utf-8")):
        assert kind_of(given) == kind


def test_every_kind_has_robots_and_no_two_robots_have_one_name():
    names = [*list_robots(), *(name for _, name in EVERY)]
    assert {kind for kind, _ in EVERY} == set(KINDS)
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    "given",
    ["puma560", "panda", "nobody", "", None, 3, float("nan"), "/no/such.yaml", "kind: [rolling]\n",
     "kind: flying\n", "a: *b\n", "<robot name='a'/>", b"kind: rolling\n"],
)  # fmt: skip
def test_arms_and_what_is_no_robot_are_of_no_kind(given):
    assert kind_of(given) == ""


def test_a_name_of_an_arm_comes_first(tmp_path, monkeypatch):
    (tmp_path / "rolling").mkdir()
    (tmp_path / "rolling" / "puma560.yaml").write_text("kind: rolling\n", encoding="utf-8")
    monkeypatch.setenv("ROBOMECH_ROBOTS_PATH", str(tmp_path))
    assert kind_of("puma560") == ""
    assert kind_of(tmp_path / "rolling" / "puma560.yaml") == "rolling"


@pytest.mark.parametrize(("kind", "name"), [one for one in EVERY if one[0] != "parallel"])
def test_what_loads_arms_and_parallel_robots_says_which_kind_it_was_given(kind, name):
    with pytest.raises(RobotDescriptionError, match=f"kind: '{kind}', expected an arm or a para"):
        load_tree_description(name)


@pytest.mark.parametrize(
    "given", ["puma560", "delta", "mecanum", " go1 ", "three_fingered", "/no/such.urdf", "a: 1", ""]
)
def test_names_that_some_robot_has_paths_and_texts_pass(given):
    check_name(given, (ARM,))


def test_an_unknown_name_lists_all_robots_of_the_kinds_that_are_taken_nearest_first():
    with pytest.raises(UnknownRobotError, match="did you mean 'mecanum'") as caught:
        check_name("mecanun", (ARM, "rolling"))
    expected = {*list_robots(), *documents_of("rolling")}
    assert caught.value.available == ("mecanum", *sorted(expected - {"mecanum"}))
    with pytest.raises(UnknownRobotError) as caught:
        check_name("hexapo", (ARM, *KINDS))
    assert caught.value.available[:2] == ("hexapod", "hexapod_walker")
    assert "more" not in str(caught.value)


@pytest.mark.parametrize(("kind", "name"), EVERY)
def test_what_loads_arms_says_of_a_file_which_kind_it_is_of(kind, name):
    expected = f"{name}.yaml: kind: '{kind}', expected the document of an arm"
    path = documents_of(kind)[name]
    with pytest.raises(RobotDescriptionError, match=expected.replace(name, path.stem)):
        load_robot(path)
