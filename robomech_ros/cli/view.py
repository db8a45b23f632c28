"""``robomech view``: a robot seen and moved in a browser, without ROS."""

from __future__ import annotations

import argparse
import threading
import webbrowser
from typing import TYPE_CHECKING, Any

from robomech_ros.cli.kind_options import refuse_options
from robomech_ros.parallel import load_parallel, load_tree_description
from robomech_ros.robots import load_semantics, main_chain
from robomech_ros.robots.documents.numbers_in_text import integer
from robomech_ros.robots.robot_kinds import ARM, check_name, kind_of
from robomech_ros.rvs.kind_registry import SEEN_KINDS
from robomech_ros.rvs.opening import kind_page_of, page_of, platform_page_of
from robomech_ros.rvs.serving.address import HOST, PORT
from robomech_ros.stop_signals import leave_on_signals

if TYPE_CHECKING:
    from robomech_ros.rvs.page.page import RobotPage

_OF_ARMS = ("base_link", "tip_link", "srdf", "group")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="puma560", help="name or path of a robot (puma560)")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--srdf", default="", help="SRDF with groups and named states")
    parser.add_argument("--group", default="", help="group of the SRDF to move")
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
    where: dict[str, Any] = {"port": args.port, "host": args.host}
    check_name(args.robot, (ARM, "parallel", *SEEN_KINDS))
    kind = kind_of(args.robot)
    if kind in SEEN_KINDS:
        refuse_options(args, _OF_ARMS, args.robot, f"a robot of kind '{kind}'")
        return kind_page_of(kind, args.robot, **where)
    described = load_tree_description(args.robot)
    if described.mechanism is not None:
        refuse_options(args, _OF_ARMS, args.robot, "a parallel robot")
        return platform_page_of(load_parallel(args.robot), **where)
    known = load_semantics(described.description, args.srdf)
    chain = main_chain(described.description, known, args.base_link, args.tip_link, args.group)
    return page_of(described.description, chain, **where)
