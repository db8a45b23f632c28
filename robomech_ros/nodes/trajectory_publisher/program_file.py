"""Which file holds the program: nobody who only reaches the node may have it read any other."""

from pathlib import Path

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings


def program_file(settings: PublisherSettings) -> Path:
    """Find the file of the program.

    Raises
    ------
    BadValueError
        There is none.
    ParameterError
        It is outside of the folder of programs.
    """
    name, folder = settings.program, settings.program_folder
    if not name:
        raise BadValueError("the parameter program", name, "the path of a YAML file")
    if not folder:
        return Path(name).expanduser()
    allowed = f"the name of a file in program_folder, '{folder}'"
    try:
        place = Path(folder).expanduser().resolve()
        path = (place / name).resolve()
    except (OSError, RuntimeError, ValueError):  # links in a circle, a null character
        raise ParameterError("program", name, allowed) from None
    if not path.is_relative_to(place):
        raise ParameterError("program", name, allowed)
    return path


def check_program_change(before: PublisherSettings, after: PublisherSettings) -> None:
    """Refuse a program that is set at run time, unless it is in the folder of programs.

    Raises
    ------
    ParameterError
        It is not, or there is no such folder.
    """
    if after.program == before.program or not after.program:
        return
    if not after.program_folder:
        allowed = "what was given at start, as there is no program_folder"
        raise ParameterError("program", after.program, allowed)
    program_file(after)
