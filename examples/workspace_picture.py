"""Compute the boundary of an arm's workspace and draw it.

Run it with:  python examples/workspace_picture.py [PICTURE]     (png, svg or pdf)
"""

import sys

from robomech_ros.kinetostatics import workspace_boundary
from robomech_ros.plotting.workspace_section import plot_workspace
from robomech_ros.robots import load_robot

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

picture = plot_workspace(sys.argv[1] if len(sys.argv) > 1 else "workspace.png", space)
print(f"drawn: {picture}")
