"""Files of meshes that a URDF names: where they are."""

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from robomech_ros.errors import RobomechError

# Archives, which others read too, may hold any size.
FORMATS = (".stl", ".obj", ".ply", ".glb", ".dae")


class MeshError(RobomechError):
    """A mesh cannot be used; the text says which and why."""

    def __init__(self, filename: str, why: str) -> None:
        super().__init__(f"mesh '{filename[:200]}' {why}")


def mesh_file(filename: str, folder: Path | None, *, anywhere: bool = False) -> Path:
    """Find the file that a URDF names.

    - ``filename``: ``package://name/...``, ``file:///...`` or a path.
    - ``folder``: folder of the URDF; None if it did not come from a file.
    - ``anywhere``: whether ``file://`` may lead out of the packages and that folder. Keep it False
      for meshes that a browser gets.

    Raises MeshError: there is no such file, or the name leads out of its package and the folder of
    the URDF.
    """
    if not filename or "\0" in filename:
        raise MeshError(filename, "has no name")
    if Path(unquote(filename)).suffix.lower() not in FORMATS:
        raise MeshError(filename, f"is none of {', '.join(FORMATS)}")
    try:
        return _found(filename, folder, anywhere)
    except OSError as error:
        raise MeshError(filename, f"cannot be looked for ({error.strerror})") from None


def _found(filename: str, folder: Path | None, anywhere: bool) -> Path:
    places = list(_places(filename, folder, anywhere))
    inside = [path for root, path in places if path.is_relative_to(root)]
    if places and not inside:
        raise MeshError(filename, "is outside of every package and of the folder of the URDF")
    for path in inside:
        if path.is_file():
            return path
    looked = ", ".join(str(path) for path in inside[:3]) or "AMENT_PREFIX_PATH, ROS_PACKAGE_PATH"
    raise MeshError(filename, f"is not there (looked for in {looked})")


def _places(filename: str, folder: Path | None, anywhere: bool) -> Iterator[tuple[Path, Path]]:
    """Yield where it may be: the folder that must contain it, and the path."""
    scheme, _, rest = filename.rpartition("://")
    if scheme in ("package", "model"):
        package, _, inside = unquote(rest).partition("/")
        if package in ("", ".", ".."):
            raise MeshError(filename, "names no package")
        for root in _package_folders(package, folder):
            yield root, _plain(root / inside)
    elif scheme == "file":
        path = _plain(Path("/") / unquote(rest).lstrip("/"))
        roots = [path.parent] if anywhere else [*_shares(), *([folder] if folder else [])]
        # Only the folder that contains it counts, if there is one.
        yield next((root for root in roots if path.is_relative_to(root)), Path("/nowhere")), path
    elif not scheme and folder is not None:
        yield folder, _plain(folder / filename)


def _plain(path: Path) -> Path:
    """Take `..` out of a path; links stay, as installed packages have them."""
    return Path(os.path.normpath(path))


def _package_folders(package: str, folder: Path | None) -> Iterator[Path]:
    for share in _shares():
        if (share / package).is_dir():
            yield share / package
    for entry in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        for root in (Path(entry), Path(entry) / package):
            if root.name == package and root.is_dir():
                yield _plain(root)
    if folder is not None:
        for root in (folder, *folder.parents):
            for place in (root, root / package):
                if place.name == package and place.is_dir():
                    yield place


def _shares() -> list[Path]:
    prefixes = filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    return [_plain(Path(prefix) / "share") for prefix in prefixes]
