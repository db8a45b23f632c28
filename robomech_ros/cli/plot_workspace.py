"""``robomech plot-workspace``: the section of what an arm's positioning part reaches."""

import argparse
import json
from pathlib import Path

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinetostatics import workspace_boundary
from robomech_ros.plotting.workspace_section import plot_workspace
from robomech_ros.robots import load_description

_ENDINGS = (".png", ".svg", ".pdf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("robot", help="name, or path of a URDF or YAML file")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--ignore-limits", action="store_true", help="joints without limits")
    parser.add_argument("--title", help="figure title (default: robot name)")
    parser.add_argument("--json", type=Path, help="also write the curves as numbers to this file")
    parser.add_argument(
        "--output", type=Path, default=Path("workspace.png"), help="png, svg or pdf"
    )


def run(args: argparse.Namespace) -> int:
    """Draw the picture; returns 0."""
    if args.output.suffix not in _ENDINGS:
        raise BadValueError("--output", str(args.output), "a file that ends with png, svg or pdf")
    chain = load_description(args.robot).chain(args.base_link or None, args.tip_link or None)
    try:
        space = workspace_boundary(chain, respect_limits=not args.ignore_limits)
    except BadValueError as error:
        instead = (
            f"`robomech map --robot {args.robot}` and `robomech plot-map` show any arm's reach"
        )
        raise RobomechError(f"{error}; {instead}") from None
    title = chain.name if args.title is None else args.title
    path = plot_workspace(args.output, space, title=title)
    if args.json is not None:
        try:
            args.json.write_text(json.dumps(space.to_dict()), encoding="utf-8")
        except OSError as error:
            expected = f"a file that can be written ({error.strerror})"
            raise BadValueError("--json", str(args.json), expected) from None
    print(
        f"{path}: {counted(len(space.curves), 'curve')}, {counted(len(space.cusps), 'cusp')}, "
        f"{counted(len(space.nodes), 'node')}; "
        f"reach {space.least_reach:.4g} to {space.greatest_reach:.4g} m"
    )
    return 0
