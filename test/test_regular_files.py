"""Only regular files are read, of a size that was agreed on, and nobody waits for a pipe."""

import os
from pathlib import Path

import pytest

from robomech_ros.regular_files import open_regular, read_regular


def test_a_file_is_read(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    with open_regular(path) as file:
        assert file.read() == b"12345"
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(OSError, match="more than 4 bytes, the most allowed"):
        read_regular(path, 4)


def test_a_link_leads_to_its_file(tmp_path):
    (tmp_path / "file").write_bytes(b"text")
    (tmp_path / "link").symlink_to("file")
    assert read_regular(tmp_path / "link", 10) == b"text"


def test_what_is_no_regular_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(OSError, match="not a regular file"):
            open_regular(path)
    with pytest.raises(FileNotFoundError):
        open_regular(tmp_path / "none")
    with pytest.raises(ValueError, match="null"):
        open_regular(Path("a\0b"))


def test_no_descriptor_is_left_open(tmp_path):
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(5):
        with pytest.raises(OSError, match="not a regular file"):
            open_regular(tmp_path)
    assert len(os.listdir("/proc/self/fd")) == before
