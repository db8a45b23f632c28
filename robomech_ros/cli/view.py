"""``robomech view``: a robot seen and moved in a browser, without ROS."""

from __future__ import annotations

import argparse
import threading
import webbrowser
from typing import TYPE_CHECKING

from robomech_ros.cli.kind_options import refuse_options
from robomech_ros.robots import load_semantics, main_chain
from robomech_ros.robots.documents.numbers_in_text import integer
from robomech_ros.rvs.kind_registry import PARALLEL
from robomech_ros.rvs.opening import page_of, shown_robot
from robomech_ros.rvs.serving.address import HOST, PORT
from robomech_ros.stop_signals import leave_on_signals

if TYPE_CHECKING:
    from robomech_ros.rvs.page.page import RobotPage

_OF_ARMS = ("base_link", "tip_link", "srdf", "group", "scene")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="puma560", help="name or path of a robot (puma560)")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--srdf", default="", help="SRDF with groups and named states")
    parser.add_argument("--group", default="", help="group of the SRDF to move")
    parser.add_argument(
        "--scene", default="", help="file with the objects around the arm, in MoveIt's layout"
    )
    parser.add_argument("--port", type=integer, default=PORT, help=f"0 = a free port ({PORT})")
    parser.add_argument(
        "--host",
        default=HOST,
        help=f"address to listen on ({HOST}: this machine only); everyone with the printed address "
        "of the page can command",
    )
    parser.add_argument("--open", action="store_true", help="also open the page in the browser")


def run(args: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C."""
    with _page(args) as page:
        leave_on_signals()
        print(f"{page.name}: open {page.url}", flush=True)
        print("Ctrl-C ends it", flush=True)
        if args.open:
            webbrowser.open(page.url)
        threading.Event().wait()
    return 0


def _page(args: argparse.Namespace) -> RobotPage:
    def refuse(kind: str) -> None:
        called = "a parallel robot" if kind == PARALLEL else f"a robot of kind '{kind}'"
        refuse_options(args, _OF_ARMS, args.robot, called)

    description, moved = shown_robot(args.robot, refuse)
    if moved is not None:
        return page_of(description, moved, port=args.port, host=args.host)
    known = load_semantics(description, args.srdf)
    chain = main_chain(description, known, args.base_link, args.tip_link, args.group)
    if not args.scene:
        return page_of(description, chain, port=args.port, host=args.host)
    # Without a scene, the collision library is not loaded.
    from robomech_ros.collision import PlanningScene

    scene = PlanningScene(chain, srdf=known)
    scene.load(args.scene)
    return page_of(description, chain, port=args.port, host=args.host, scene=scene)
