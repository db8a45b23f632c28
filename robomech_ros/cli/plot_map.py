"""``robomech plot-map``: slices through a map of reach and dexterity."""

import argparse
from pathlib import Path

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import load_reach_map
from robomech_ros.plotting.map_slices import QUANTITIES, plot_map
from robomech_ros.robots.documents.numbers_in_text import number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("file", type=Path, help="file written by `robomech map`")
    parser.add_argument(
        "--quantity", default="dexterity", help=f"{', '.join(QUANTITIES)} (dexterity)"
    )
    parser.add_argument("--axis", help="normal of the slice: x, y or z (each)")
    parser.add_argument("--at", type=number, help="position on that axis, m (the middle)")
    parser.add_argument("--title", help="figure title (default: robot and tip)")
    parser.add_argument("--output", type=Path, default=Path("map.png"), help="png, svg or pdf")


def run(args: argparse.Namespace) -> int:
    """Draw the picture; returns 0."""
    if args.output.suffix not in (".png", ".svg", ".pdf"):
        raise BadValueError("--output", str(args.output), "a file that ends with png, svg or pdf")
    reach = load_reach_map(args.file)
    options = {"quantity": args.quantity, "axis": args.axis, "at": args.at, "title": args.title}
    try:
        path = plot_map(args.output, reach, **options)
    except OSError as error:
        expected = f"a file that can be written ({error.strerror})"
        raise BadValueError("--output", str(args.output), expected) from None
    print(f"{path}: {reach.finished:,} of {reach.grid.cells:,} points")
    return 0
