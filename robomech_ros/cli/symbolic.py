"""``robomech symbolic``: closed forms of a robot's kinematics and dynamics."""

import argparse
import sys
from importlib.util import find_spec

from robomech_ros.robots import load_description
from robomech_ros.robots.documents.numbers_in_text import number

EXIT_NONE = 1

EXPRESSIONS = (
    "forward_kinematics",
    "jacobian",
    "mass_matrix",
    "coriolis_matrix",
    "gravity_torque",
    "torque",
    "friction_torque",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", required=True, help="name, or path of a URDF or YAML file")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument(
        "--what", default="mass_matrix", choices=EXPRESSIONS, help="expression (mass_matrix)"
    )
    parser.add_argument(
        "--numbers", action="store_true", help="the robot's numbers instead of symbols"
    )
    parser.add_argument(
        "--gravity",
        nargs=3,
        type=number,
        default=(0.0, 0.0, -9.81),
        metavar=("X", "Y", "Z"),
        help="gravity vector in the base, m/s^2 (0 0 -9.81)",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--latex", action="store_true", help="as LaTeX")
    form.add_argument("--python", action="store_true", help="as a Python function with numpy")


def run(args: argparse.Namespace) -> int:
    """Print the expressions; returns 0, or 1 where SymPy is missing."""
    if find_spec("sympy") is None:
        print(
            "robomech symbolic: SymPy is missing; pip install 'robomech_ros[symbolic]'",
            file=sys.stderr,
        )
        return EXIT_NONE
    # Here, since SymPy is optional.
    from robomech_ros.dynamics.symbolic.closed_forms import symbolic_model
    from robomech_ros.dynamics.symbolic.printing import FORMS

    chain = load_description(args.robot).chain(args.base_link or None, args.tip_link or None)
    parameters = "numbers" if args.numbers else "names"
    model = symbolic_model(chain, gravity=args.gravity, parameters=parameters)
    form = "latex" if args.latex else "python" if args.python else "text"
    print(FORMS[form](model, args.what))
    return 0
