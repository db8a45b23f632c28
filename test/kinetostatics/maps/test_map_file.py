"""Files of maps: what is read is what was written, or is refused with a reason."""

import io
import json
import os
import zipfile

import numpy as np
import pytest

from robomech_ros.errors import MapFileError, NotEnoughMemoryError
from robomech_ros.kinetostatics import load_reach_map, reach_map
from robomech_ros.kinetostatics.maps.cells import CELL
from robomech_ros.robots import load_robot

PUMA = load_robot("puma560")
BOX = {"lower": [0, 0, 0], "upper": [0.7, 0.6, 0.5], "spacing": 0.2, "orientations": 3}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    file = tmp_path_factory.mktemp("maps") / "map.npz"
    reach_map(PUMA, **BOX, length=0.3, file=file)
    return file


def parts_of(file):
    with zipfile.ZipFile(file) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def array(values):
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, values, allow_pickle=values.dtype == object)
    return buffer.getvalue()


def header_of(parts):
    return json.loads(np.load(io.BytesIO(parts["header.npy"])).tobytes())


def with_header(**changes):
    """Write the file anew with another header."""

    def change(parts):
        header = {**header_of(parts), **changes}
        text = json.dumps({name: value for name, value in header.items() if value is not None})
        parts["header.npy"] = array(np.frombuffer(text.encode(), np.uint8))

    return change


def with_part(name, content):
    return lambda parts: parts.update({name: content})


def rewritten(file, place, change):
    parts = parts_of(file)
    change(parts)
    with zipfile.ZipFile(place, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return place


def test_what_is_read_is_what_was_written(whole, tmp_path):
    found = load_reach_map(whole, PUMA)
    assert found.robot.name == "puma560"
    assert (found.robot.base, found.robot.tip) == ("base_link", "tool0")
    assert found.grid.shape == (4, 4, 3)
    assert np.allclose(found.grid.upper, [0.6, 0.6, 0.4])
    assert found.complete
    again = load_reach_map(found.save(tmp_path / "copy.npz"))
    assert again.cells.tobytes() == found.cells.tobytes()
    assert again.request.header == found.request.header
    assert np.array_equal(again.request.orientations, found.request.orientations)


CELLS = np.zeros(48, CELL)
TOO_MANY = CELLS.copy()
TOO_MANY["reached"][7] = 4


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (with_header(format="robomech map 0"), "does not say that it is a robomech map 1"),
        (with_header(robot=None), "damaged one: 'robot'"),
        (with_header(robot={"name": "puma560"}), "missing 3 required"),
        (with_header(shape=[4, 4, 4]), "its grid and its number of cells do not agree"),
        (with_header(shape=[4, 4, 10**15]), "its grid and its number of cells do not agree"),
        (with_header(shape=[4, 4, -3]), "damaged: shape is"),
        (with_header(lower=[0, 0, float("nan")]), r"damaged: lower\[2\] is nan"),
        (with_header(length="long"), "damaged: length is 'long'"),
        (with_header(part="all"), "damaged: part is 'all'"),
        (with_header(orientations="0" * 64), "its orientations are not those"),
        (with_part("orientations.npy", array(np.zeros((3, 3, 3)))), "damaged: orientations"),
        (with_part("orientations.npy", b"nothing"), "not a map, or a damaged one"),
        (with_part("header.npy", array(np.zeros(1 << 17, np.uint8))), "its header is too long"),
        (with_part("header.npy", array(np.array([{}], object))), "allow_pickle"),
        (with_part("header.npy", array(np.frombuffer(b"[" * 60_000, np.uint8))), "damaged one"),
        (with_part("cells.npy", array(CELLS.view(np.uint8))), "its cells have the wrong form"),
        (with_part("cells.npy", array(TOO_MANY)), "more orientations reached than were tried"),
        (with_part("more.npy", b""), "it lacks parts of a map, or has others"),
    ],
)
def test_a_damaged_file_is_refused_with_a_reason(change, text, whole, tmp_path):
    file = rewritten(whole, tmp_path / "map.npz", change)
    with pytest.raises(MapFileError, match=text) as caught:
        load_reach_map(file)
    assert str(file) in str(caught.value)
    with pytest.raises(MapFileError):
        reach_map(PUMA, **BOX, length=0.3, file=file)


def test_nobody_waits_for_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "map.npz")
    with pytest.raises(MapFileError, match="cannot be read: not a regular file"):
        load_reach_map(tmp_path / "map.npz")


def test_a_file_cut_or_with_a_flipped_bit_is_refused(whole, tmp_path):
    file, content = tmp_path / "map.npz", whole.read_bytes()
    for damaged in (b"", content[:100], content[:-30], b"text\n" * 50):
        file.write_bytes(damaged)
        with pytest.raises(MapFileError, match="not a map, or a damaged one"):
            load_reach_map(file)
    place = content.index(b"cells.npy") + 600
    file.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
    with pytest.raises(MapFileError, match="Bad CRC-32"):
        load_reach_map(file)


def test_a_file_that_claims_more_than_there_is_memory_is_refused(whole, tmp_path, monkeypatch):
    monkeypatch.setattr("robomech_ros.numerics.memory.available_memory", lambda: 100)
    with pytest.raises(NotEnoughMemoryError, match="of which 100 bytes are available"):
        load_reach_map(whole)


@pytest.mark.parametrize(
    ("other", "text"),
    [
        ({"length": 0.4}, "its length is 0.3, not 0.4"),
        ({"orientations": 4}, "its orientations is"),
        ({"spacing": 0.21}, "its upper is"),
        ({"respect_limits": False}, "its respect_limits is true, not false"),
        ({"part": "position"}, 'its part is "pose", not "position"'),
    ],
)
def test_another_map_is_not_written_over(other, text, whole):
    before = whole.read_bytes()
    with pytest.raises(MapFileError, match=text):
        reach_map(PUMA, **(BOX | {"length": 0.3} | other), file=whole)
    with pytest.raises(MapFileError, match="another map is there: it is of robot 'puma560'"):
        reach_map(load_robot("ur5e"), **BOX, length=0.3, file=whole)
    assert whole.read_bytes() == before


def test_a_place_that_cannot_be_written_is_told_before_anything_is_computed(tmp_path):
    for place, text in (
        (tmp_path / "nowhere" / "map.npz", "cannot be written: No such file or directory"),
        (tmp_path / "map.txt", "ends with .npz"),
        (tmp_path, "ends with .npz"),
        (tmp_path / f"{'m' * 300}.npz", "cannot be written: File name too long"),
    ):
        with pytest.raises(MapFileError, match=text):
            reach_map(PUMA, **BOX, file=place, progress=lambda *_: pytest.fail("began"))
    (tmp_path / "folder.npz").mkdir()
    with pytest.raises(MapFileError, match="this is no file"):
        reach_map(PUMA, **BOX, file=tmp_path / "folder.npz")
    with pytest.raises(MapFileError, match="cannot be read: No such file"):
        load_reach_map(tmp_path / "none.npz")
