"""``robomech view``: a robot seen and moved in a browser, without ROS."""

import argparse
import threading
import webbrowser

from robomech_ros.robots import load_description, main_chain, semantics_of
from robomech_ros.rvs.opening import page_of
from robomech_ros.rvs.serving.address import HOST, PORT
from robomech_ros.stop_signals import leave_on_signals

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", default="puma560", help="name or path of a robot (puma560)")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    parser.add_argument("--srdf", default="", help="SRDF with groups and named states")
    parser.add_argument("--group", default="", help="the group of the SRDF that moves")
    parser.add_argument("--port", type=int, default=PORT, help=f"0 takes a free one ({PORT})")
    parser.add_argument(
        "--host",
        default=HOST,
        help=f"address to listen on ({HOST}: this machine alone reaches it); whoever has the "
        "printed address of the page may command",
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser, too")


def run(args: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C."""
    description = load_description(args.robot)
    known = semantics_of(description, args.srdf)
    chain = main_chain(description, known, args.base_link, args.tip_link, args.group)
    with page_of(description, chain, port=args.port, host=args.host) as page:
        leave_on_signals()
        print(f"{chain.name}: open {page.url}", flush=True)
        print("Ctrl-C ends it", flush=True)
        if args.open:
            webbrowser.open(page.url)
        threading.Event().wait()
    return 0
