"""The demonstration of a walking machine: an eight is walked, and every foot looked at."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.demonstration.client import DemoClient, running_client
from robomech_ros.nodes.demonstration.closed_paths import ClosedPath, figure_of_eight
from robomech_ros.nodes.demonstration.path_follower import PathFollower
from robomech_ros.nodes.demonstration.report import Reporter, whole_motion, write_motion_page
from robomech_ros.nodes.demonstration.walk import Walk
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.plotting.walks import plot_walk
from robomech_ros.rvs.model.walking.placed_tree import placed_tree, placing
from robomech_ros.typing import Array
from robomech_ros.walking import GAITS, LeggedRobot, Walker, load_legged

# How long the walk should take (s), the parts of the greatest twists that it uses, and the
# acceleration on the way (m/s^2).
_SECONDS, _SPEED, _TURN, _ACCELERATION = 15.0, 0.5, 0.2, 0.2
# How far the walk is ahead of its time, and joints may lag (s): a busy machine does not end it.
_LEAD, _LAG = 1.0, 2.0
# How far from its beginning the trunk may end (m, rad), by odometry.
_ARRIVED, _ARRIVED_ANGLE = 0.005, 0.01
# How far a foot that stands may be from where it is said to be (m), as the joints have it, on the
# way and at rest; where the trunk is between messages is known if they are not further apart (s).
_SLIPPED, _FOOT, _NEIGHBOURS = 0.002, 1e-4, 0.045


def demonstrate(robot: str, output: Path) -> None:
    """Walk an eight with a walking machine, and tell about it."""
    reporter, legged = Reporter(), load_legged(robot)
    walker = quickest(legged)
    path, radius, speed = eight_for(walker)
    reporter.heading(
        f"{legged.name}: {len(legged.legs)} legs, {legged.n} joints, gait {walker.gait}, "
        f"a cycle of {walker.cycle:.2f} s"
    )
    commands = LaunchOptions(robot, kind="walking").commands()
    for name, value in {"gait": walker.gait, "lead": _LEAD, "tracking_delay": _LAG}.items():
        commands["walker"] += ["-p", f"{name}:={value}"]
    with running_client(commands, legged.joint_names, legged.units) as (suite, client):
        client.wait_until_up({})
        walk = Walk(client, _LEAD)
        walk.wait_until_it_stands()
        reporter.up(suite)
        reporter.say(
            f"{path.name}: {path.length:.2f} m at {speed * 1e3:.0f} mm/s, by twists on cmd_vel"
        )
        follower = PathFollower(None, path, speed, _ACCELERATION, radius)
        took = walk.follow(follower, path.length / speed)
        places = _planned(walk, path)
        off = max(np.hypot(*(places - T[:2, 3]).T).min() for T in walk.trunk[1])
        reporter.say(f"walked in {took:.1f} s, never more than {off * 1e3:.1f} mm off it")
        _check(walker, walk, client, reporter)
        plot = _plot(walker, walk, path, output)
        page = _page(legged, walk, client, output)
    reporter.finish(f"plot: {plot}", page)


def quickest(robot: LeggedRobot) -> Walker:
    """Return the fastest gait without sway; BadValueError if none suits the number of legs."""
    own = [gait for gait in GAITS.values() if len(robot.legs) in gait.offsets]
    return Walker(robot, gait=min(own, key=lambda gait: gait.duty).name if own else None)


def eight_for(walker: Walker) -> tuple[ClosedPath, float, float]:
    """Return a figure-eight path for a walker, its radius (m) and speed (m/s)."""
    turn, ahead = walker.fastest[:2]
    speed = _SPEED * float(ahead)
    # Its length is in proportion to its radius.
    radius = speed * _SECONDS / figure_of_eight(1.0, looking_ahead=False).length
    path = figure_of_eight(radius, looking_ahead=False)
    swings = 2.0 * np.pi * path.lengths / path.length
    amplitude = _TURN * float(turn) * _SECONDS / (2.0 * np.pi)
    headings = amplitude * np.sin(swings)
    return replace(path, name="eight, looking about", headings=headings), radius, speed


def _planned(walk: Walk, path: ClosedPath) -> Array:
    """Return the path over the ground (m), shape (p, 2): it begins where the walk does."""
    begin = walk.trunk[1][0]
    return np.asarray(path.places @ begin[:2, :2].T + begin[:2, 3])


def _check(walker: Walker, walk: Walk, client: DemoClient, reporter: Reporter) -> None:
    """See that the trunk is where it began, by odometry and by legs, and that nothing tipped."""
    robot = walker.robot
    _, trunk = walk.trunk
    away = np.linalg.inv(trunk[0]) @ trunk[-1]
    off = float(np.linalg.norm(away[:2, 3]))
    turned = abs(float(np.arctan2(away[1, 0], away[0, 0])))
    text = f"by odometry it is {off * 1e3:.2f} mm and {turned * 1e3:.2f} mrad from where it began"
    reporter.check(off <= _ARRIVED and turned <= _ARRIVED_ANGLE, text)
    _, contacts, places = walk.feet
    at_rest = np.abs(_on_ground(robot, client.present[None], trunk[-1:]) - places[-1]).max()
    count, off = _slip(robot, walk, client)
    text = (
        f"by the joints, standing feet are at most {off * 1e3:.2f} mm from where they are said to "
        f"be, seen {count} times, and {at_rest * 1e3:.4f} mm at the end"
    )
    stands = at_rest <= _FOOT and bool(contacts[-1].all())
    reporter.check(count > 0 and off <= _SLIPPED and stands, text)
    least = walk.margins.min()
    text = f"stability margin: at least {least * 1e3:.1f} mm, bound {walker.bound * 1e3:.0f} mm"
    reporter.check(least >= walker.bound - 1e-9, text)


def _slip(robot: LeggedRobot, walk: Walk, client: DemoClient) -> tuple[int, float]:
    """Compare where feet are by joints, and where they are said to stand; give the worst (m)."""
    moments, trunk = walk.trunk
    times, contacts, places = walk.feet
    both, of_trunk, of_feet = np.intersect1d(moments, times, return_indices=True)
    trunk, contacts, places = trunk[of_trunk], contacts[of_feet], places[of_feet]
    sampled, q, _ = client.recording()
    sampled = sampled + client.began
    after = np.searchsorted(both, sampled)
    inside = (after > 0) & (after < len(both))
    sampled, q, after = sampled[inside], q[inside], after[inside]
    lasted = both[after] - both[after - 1]
    near = lasted < _NEIGHBOURS
    sampled, q, after, lasted = sampled[near], q[near], after[near], lasted[near]
    part = ((sampled - both[after - 1]) / lasted)[:, None, None]
    # So near, the trunk moves evenly.
    T = (1.0 - part) * trunk[after - 1] + part * trunk[after]
    stands = contacts[after - 1] & contacts[after]
    off = np.linalg.norm(_on_ground(robot, q, T) - places[after], axis=2)[stands]
    return off.size, float(off.max(initial=0.0))


def _on_ground(robot: LeggedRobot, q: Array, T: Array) -> Array:
    """Return where the feet are over the ground (m), (m, k, 3), by joints and by the trunk."""
    feet = [
        forward_kinematics(leg, q[:, 3 * k : 3 * k + 3])[:, :3, 3]
        for k, leg in enumerate(robot.legs)
    ]
    seen = np.stack(feet, axis=1) @ T[:, :3, :3].transpose(0, 2, 1)
    return np.asarray(seen + T[:, None, :3, 3])


def _plot(walker: Walker, walk: Walk, path: ClosedPath, output: Path) -> Path:
    robot = walker.robot
    times, trunk = walk.trunk
    _, contacts, places = walk.feet
    footholds = [
        np.unique(places[contacts[:, k], k, :2].round(6), axis=0) for k in range(len(robot.legs))
    ]
    count = min(len(times), len(walk.margins))
    return plot_walk(
        output / f"{robot.name}.png",
        robot.leg_names,
        times[:count] - times[0],
        trunk[:count, :2, 3],
        footholds,
        walk.margins[:count],
        bound=walker.bound,
        planned=_planned(walk, path),
        title=f"{robot.name}: an eight in the gait {walker.gait}, by odom and foot_contacts",
    )


def _page(robot: LeggedRobot, walk: Walk, client: DemoClient, output: Path) -> str:
    height = -float(robot.feet(robot.home)[:, 2].mean())
    tree = placed_tree(robot.description, robot.trunk, height)
    times, trunk = walk.trunk
    sampled, q, _ = client.recording()
    joints = [np.interp(times, sampled + client.began, column) for column in q.T]
    columns = dict(zip(robot.joint_names, joints, strict=True))
    heading = np.unwrap(np.arctan2(trunk[:, 1, 0], trunk[:, 0, 0]))
    bases = np.column_stack([trunk[:, :2, 3], heading])
    placed = [placing(base, T, height) for base, T in zip(bases, trunk, strict=True)]
    columns |= {name: np.array([one[name] for one in placed]) for name in placed[0]}
    keep = np.diff(times, prepend=-np.inf) > 0.0
    kept = {name: column[keep] for name, column in columns.items()}
    motion = whole_motion(tree, times[keep] - times[0], kept)
    return write_motion_page(output, robot.name, "an eight", tree, motion, robot.trunk)
