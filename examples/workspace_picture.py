"""Compute the boundary of an arm's workspace and draw it.

Run it with:  python examples/workspace_picture.py [PICTURE]     (png, svg or pdf)
"""

import argparse

from robomech_ros.kinetostatics import workspace_boundary
from robomech_ros.plotting import plot_workspace
from robomech_ros.robots import load_robot

parser = argparse.ArgumentParser(description="Draw the boundary of a workspace.")
parser.add_argument("picture", nargs="?", default="workspace.png", help="png, svg or pdf")
picture = parser.parse_args().picture

space = workspace_boundary(load_robot("puma560"))
print(f"the wrist centre reaches {space.least_reach:.3f} to {space.greatest_reach:.3f} m")
for cause in sorted({curve.cause for curve in space.curves}):
    roles = [curve.role for curve in space.curves if curve.cause == cause]
    print(f"    {len(roles)} curves, {cause}: {', '.join(roles)}")

points = [[0.4, 0.1, 0.3], [0.9, 0.9, 0.9]]  # m, in the base; distances are negative outside
for point, count, distance in zip(
    points, space.solution_count(points), space.distance(points), strict=True
):
    print(f"{point}: {count} postures, {distance:+.3f} m from the boundary")

print(f"drawn: {plot_workspace(picture, space)}")
