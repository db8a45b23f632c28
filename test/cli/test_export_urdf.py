"""`robomech export-urdf`."""

import pytest

from robomech_ros.cli.main import main
from robomech_ros.robots import load_description, load_robot, urdf_from_description


def test_a_document_goes_to_a_file_or_to_standard_output(tmp_path, capsys):
    path = tmp_path / "puma.urdf"
    assert main(["export-urdf", "puma560", "--output", str(path)]) == 0
    assert capsys.readouterr().out == f"wrote {path}\n"
    assert load_robot(path, tip="tool0").joint_names == load_robot("puma560").joint_names
    assert main(["export-urdf", "puma560"]) == 0
    assert capsys.readouterr().out == path.read_text(encoding="utf-8")
    assert path.read_text(encoding="utf-8") == urdf_from_description(load_description("puma560"))


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["no_robot"], 2, "unknown robot 'no_robot'"),
        (["ur5e", "--output", "/nowhere/arm.urdf"], 1, "/nowhere/arm.urdf: No such file"),
    ],
)
def test_what_cannot_be_written(arguments, code, text, capsys):
    assert main(["export-urdf", *arguments]) == code
    assert text in capsys.readouterr().err
