"""The examples in doc/: blocks of Python run alone, robots in YAML load; no ROS needed."""

import ast
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.robots import list_robots, load_robot

ROOT = Path(__file__).resolve().parent.parent
DOC = ROOT / "doc"
sys.path.insert(0, str(DOC / "extensions"))

from notebook_parts import cells  # noqa: E402
from public_names import public_packages  # noqa: E402

PAGES = sorted([*DOC.glob("*.md"), *DOC.glob("notebooks/*.md")])


def blocks(page: Path, language: str) -> list[str]:
    """Return the fenced blocks of a language in a page."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


# What a comment behind an expression says of its value: a literal, or a number and its unit.
SHOWN = re.compile(r"  # (True|False|None|\('.*?'\)|-?\d+(?:\.\d+)?)(?= |$|[,;:])")


def agrees(value: object, shown: str) -> bool:
    """Whether a value is what a comment says, a number to the digits that it has."""
    wanted = ast.literal_eval(shown)
    if isinstance(wanted, bool | None | tuple):
        return value == wanted
    half = 0.5 * 10.0 ** -len(shown.partition(".")[2])
    return abs(float(value) - wanted) <= half * (1.0 + 1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "source",
    [
        pytest.param(source, id=f"{page.stem}-{number}")
        for page in [ROOT / "README.md", *PAGES]
        for number, source in enumerate(blocks(page, "python"), start=1)
    ],
)
def test_a_python_block_runs_alone_and_gives_what_its_comments_say(source, monkeypatch, tmp_path):
    # As in the folder of the repository, but for the files that it writes.
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    names: dict[str, object] = {}
    lines = source.splitlines()
    for statement in ast.parse(source).body:
        text = ast.unparse(statement)
        exec(compile(text, "block", "exec"), names)
        shown = SHOWN.search(lines[(statement.end_lineno or 1) - 1])
        if shown is None:
            continue
        if isinstance(statement, ast.Assign):
            value = names[ast.unparse(statement.targets[0])]
        else:
            value = eval(text, names)
        assert agrees(value, shown[1]), f"{text} gives {value}, not {shown[1]}"


def test_documents_and_examples_import_only_what_has_an_entry_in_the_interface():
    sources = [path.read_text("utf-8") for path in (ROOT / "examples").glob("*.py")]
    for page in [ROOT / "README.md", *PAGES]:
        sources += blocks(page, "python")
        sources += [cell.source for cell in cells(page.read_text("utf-8"))]
    nodes = [node for source in sources for node in ast.walk(ast.parse(source))]
    imports = [node for node in nodes if isinstance(node, ast.ImportFrom)]
    ours = [node for node in imports if (node.module or "").startswith("robomech_ros.")]
    assert len(ours) > 200
    named = {f"{node.module}.{alias.name}" for node in ours for alias in node.names}
    public = {f"{package}.{name}" for package, names in public_packages().items() for name in names}
    assert sorted(named - public - public_packages().keys()) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_lines_of_prose_wrap(page):
    pattern = r"^ *```.*?^ *```|^\$\$$.*?^\$\$$"  # code and formulas are as long as they are
    text = re.sub(pattern, "", page.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
    long = [line for line in text.splitlines() if len(line) > 120 and not line.startswith("|")]
    assert not long


def test_every_page_is_in_the_table_of_contents():
    named = re.findall(r"^[a-z_]+$", (DOC / "index.md").read_text("utf-8"), re.MULTILINE)
    pages = {path.stem for path in DOC.iterdir() if path.suffix in (".md", ".rst")} - {"index"}
    assert sorted(named) == sorted(pages)


def test_robot_in_yaml_loads_and_the_file_beside_a_urdf_is_accepted(tmp_path):
    table, beside = blocks(DOC / "robots.md", "yaml")
    assert load_robot(table).joint_names == ("joint_1", "joint_2")
    robots = ROOT / "config" / "robots"
    (tmp_path / "arm.urdf").write_bytes((robots / "ur5e.urdf").read_bytes())
    (tmp_path / "arm.yaml").write_text(beside, encoding="utf-8")
    assert load_robot(tmp_path / "arm.urdf").jerk[0] == 31.416


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_links_between_pages_lead_somewhere(page):
    text = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
    )
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if not target.startswith(("http:", "https:")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_every_robot_is_in_the_table_with_its_family():
    text = (DOC / "robots.md").read_text(encoding="utf-8").split("## Base and tip")[0]
    rows = [line.split("|") for line in text.splitlines() if line.startswith("| `")]
    families = {name: row[4].strip() for row in rows for name in re.findall(r"`(\w+)`", row[1])}
    assert families == {name: family_of(load_robot(name)).name for name in list_robots()}


def test_every_error_code_is_explained():
    text = (DOC / "interfaces.md").read_text(encoding="utf-8")
    explained = re.findall(r"^\| (\d+) \| `(\w+)` \|", text, re.MULTILINE)
    definition = ROOT / "robomech_interfaces" / "msg" / "ErrorCode.msg"
    constants = re.findall(r"^uint16 (\w+)=(\d+)", definition.read_text("utf-8"), re.MULTILINE)
    assert explained == [(number, name) for name, number in constants]


def test_every_folder_of_the_package_is_in_the_architecture():
    text = (DOC / "architecture.md").read_text(encoding="utf-8")
    tree = text.split("```text\n", 1)[1].split("```", 1)[0]
    shown: set[str] = set()
    above: list[str] = []
    for line in tree.splitlines()[1:]:
        names = re.findall(r"(?<=\s)(\w+)/(?=\s|$)", f" {line}")
        if names:
            del above[line.index(names[0]) // 4 - 1 :]
            shown |= {"/".join([*above, name]) for name in names}
            above.append(names[0])
    package = ROOT / "robomech_ros"
    folders = {str(path.parent.relative_to(package)) for path in package.rglob("*.py")} - {"."}
    assert shown == folders


@pytest.mark.parametrize("page", ["architecture", "extending"])
def test_every_module_that_is_named_is_there(page):
    text = (DOC / f"{page}.md").read_text(encoding="utf-8")
    modules = [path.relative_to(ROOT).as_posix() for path in ROOT.glob("*/**/*.py")]
    for named in re.findall(r"`([\w/]+\.py)`", text):
        assert any(f"/{module}".endswith(f"/{named}") for module in modules), named


def test_the_citation_names_what_the_package_names():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    assert citation["cff-version"] == "1.2.0"
    assert citation["message"]
    assert citation["authors"] == [{"name": author.text} for author in package.iter("author")]
    assert citation["title"].startswith(package.findtext("name") + ":")
    assert citation["version"] == package.findtext("version")
    assert citation["license"] == package.findtext("license")
    assert citation["url"] == package.findtext("url")
    bibtex = blocks(DOC / "citing.md", "text")[0]
    assert f"version = {{{citation['version']}}}" in bibtex


def test_the_image_has_what_the_set_up_asks_for():
    image = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    asked = (ROOT / "tools" / "find_python.sh").read_text(encoding="utf-8")
    packages = re.findall(r"apt-get install ([^\"\n]+)", asked)[0].split()
    installed = re.findall(r"apt-get install .*", image)[0].split()
    assert {*packages, "g++", "make"} <= {*installed}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r'make"?,? "?(\w+)', image.split("WORKDIR")[1]):
        assert f"\n{target}:" in makefile, target
