"""Pictures of postures, motions, simulations, workspaces, maps and loci, drawn with matplotlib.

The first argument of each function is the path of the picture; its ending (png, svg, pdf) gives the
format. The function writes the picture, with ``title`` above it, and returns the path. Without
matplotlib, it raises PlottingUnavailableError. Each part is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.plotting.condition_loci import plot_condition_loci as plot_condition_loci
    from robomech_ros.plotting.joint_motions import plot_motion as plot_motion
    from robomech_ros.plotting.map_slices import plot_map as plot_map
    from robomech_ros.plotting.pictures import PlottingUnavailableError as PlottingUnavailableError
    from robomech_ros.plotting.postures import plot_postures as plot_postures
    from robomech_ros.plotting.simulations import plot_simulation as plot_simulation
    from robomech_ros.plotting.workspace_section import plot_workspace as plot_workspace

__getattr__, __all__ = lazy_exports(__name__, globals())
