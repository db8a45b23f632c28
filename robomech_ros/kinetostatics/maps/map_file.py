"""Maps in files: an interrupted write leaves the previous file, and reading checks everything."""

import json
import os
import tempfile
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, MapFileError, NotEnoughMemoryError, RobomechError
from robomech_ros.kinetostatics.indices import as_length
from robomech_ros.kinetostatics.maps.box_grid import BoxGrid, as_grid
from robomech_ros.kinetostatics.maps.cells import CELL, UNFINISHED
from robomech_ros.kinetostatics.maps.request import MapRequest, RobotIdentity
from robomech_ros.kinetostatics.rotation_sets import as_orientations
from robomech_ros.kinetostatics.task_parts import PARTS
from robomech_ros.numerics.memory import check_memory
from robomech_ros.regular_files import open_regular
from robomech_ros.spatial.arrays import as_choice

_FORMAT = "robomech map 1"
_MEMBERS = ("header", "orientations", "cells")
_LARGEST_HEADER = 1 << 16
# Longest header of numpy in front of an array.
_PREAMBLE = 1 << 12


def as_path(file: str | os.PathLike[str]) -> Path:
    """Check the name of a file."""
    if not isinstance(file, str | os.PathLike) or not str(file) or "\0" in str(file):
        raise BadValueError("file", file, "the path of a file")
    return Path(file)


def check_writable(path: Path) -> None:
    """Refuse a file that could not be written, before anything is computed for it."""
    if path.suffix != ".npz":
        raise MapFileError(str(path), "a map is kept in a file whose name ends with .npz")
    try:
        if path.exists() and not path.is_file():
            raise MapFileError(str(path), "this is no file")
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.stem}."):
            pass
    except OSError as error:
        raise _unwritable(path, error) from None


def save_map(path: Path, request: MapRequest, cells: NDArray) -> None:
    """Write a map, finished or not; until all of it is on the disk the file keeps what it had."""
    check_writable(path)
    header = json.dumps({"format": _FORMAT, **request.header}).encode()
    part = path.with_name(f".{path.stem}.{os.getpid()}.part")
    try:
        with part.open("wb") as file:
            np.savez(
                file,
                header=np.frombuffer(header, np.uint8),
                orientations=request.orientations,
                cells=cells,
            )
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except OSError as error:
        raise _unwritable(path, error) from None
    finally:
        part.unlink(missing_ok=True)


def load_map(path: Path) -> tuple[MapRequest, NDArray]:
    """Read a map and its cells; all that it claims is checked before it is believed."""
    try:
        with open_regular(path) as file:
            return _read(path, file)
    except OSError as error:
        raise MapFileError(str(path), f"cannot be read: {error.strerror or error}") from None


def _read(path: Path, file: IO[bytes]) -> tuple[MapRequest, NDArray]:
    try:
        with zipfile.ZipFile(file) as archive:
            sizes = {info.filename: info.file_size for info in archive.infolist()}
            if set(sizes) != {f"{name}.npy" for name in _MEMBERS}:
                raise ValueError("it lacks parts of a map, or has others")
            header = _header(archive, sizes["header.npy"])
            grid = as_grid(header["lower"], header["upper"], None, header["shape"])
            robot = _robot(header)
            size = grid.cells * CELL.itemsize
            if not size <= sizes["cells.npy"] <= size + _PREAMBLE:
                raise ValueError("its grid and its number of cells do not agree")
            check_memory(f"the map in {path}", sizes["cells.npy"] + sizes["orientations.npy"])
            request = MapRequest(
                robot=robot,
                grid=grid,
                orientations=as_orientations(_array(archive, "orientations")),
                respect_limits=bool(header["respect_limits"]),
                length=as_length(header["length"]),
                part=as_choice("part", header["part"], tuple(PARTS)),
                version=str(header["version"]),
            )
            if request.header["orientations"] != header["orientations"]:
                raise ValueError("its orientations are not those that it was made with")
            return request, _cells(archive, grid, len(request.orientations))
    except NotEnoughMemoryError:
        raise
    except RobomechError as error:
        raise MapFileError(str(path), f"damaged: {error}") from None
    except (
        ValueError, KeyError, TypeError, EOFError, NotImplementedError, OverflowError,
        MemoryError, RuntimeError, zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error,
    ) as error:  # fmt: skip
        raise MapFileError(str(path), f"not a map, or a damaged one: {error}") from None


def _header(archive: zipfile.ZipFile, size: int) -> dict[str, Any]:
    if size > _LARGEST_HEADER:
        raise ValueError("its header is too long")
    header = json.loads(_array(archive, "header").tobytes())
    if not isinstance(header, dict) or header.get("format") != _FORMAT:
        raise ValueError(f"it does not say that it is a {_FORMAT}")
    return header


def _robot(header: dict[str, Any]) -> RobotIdentity:
    robot = RobotIdentity(**header["robot"])
    if not all(isinstance(text, str) for text in vars(robot).values()):
        raise ValueError("it does not say of which robot it is")
    return robot


def _cells(archive: zipfile.ZipFile, grid: BoxGrid, orientations: int) -> NDArray:
    cells = _array(archive, "cells")
    if cells.dtype != CELL or cells.shape != (grid.cells,):
        raise ValueError("its cells have the wrong form")
    reached = cells["reached"]
    if ((reached < UNFINISHED) | (reached > orientations)).any():
        raise ValueError("a cell has more orientations reached than were tried")
    return cells


def _array(archive: zipfile.ZipFile, name: str) -> NDArray:
    with archive.open(f"{name}.npy") as member:
        array: NDArray = np.lib.format.read_array(member, allow_pickle=False)
        if member.read(1):
            raise ValueError(f"there is something behind its {name}")
    return array


def _unwritable(path: Path, error: OSError) -> MapFileError:
    return MapFileError(str(path), f"cannot be written: {error.strerror or error}")
