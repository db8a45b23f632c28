"""Surroundings of a robot: ground and lights; nothing is loaded from outside."""

import math
from typing import Any

from robomech_ros.rvs.model.camera import FIELD, fitted_camera
from robomech_ros.typing import Array

# Lights without shadows or pictures: software draws them in a tenth of a second.
AMBIENT, SKY = 1.2, 1.4
# Widths of the squares on the ground (m), the least of which a robot's reach has at most so many.
SQUARES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
MOST_SQUARES = 12


def add_surroundings(server: Any, reach: float) -> Any:
    """Add ground and lights to a scene; return the ground (viser.GridHandle)."""
    scene = server.scene
    scene.configure_environment_map(None)
    scene.configure_default_lights(cast_shadow=False)
    scene.add_light_ambient("/lights/ambient", intensity=AMBIENT)
    scene.add_light_hemisphere(
        "/lights/sky", intensity=SKY, sky_color=(255, 255, 255), ground_color=(150, 150, 160)
    )
    square = next((width for width in SQUARES if reach / width <= MOST_SQUARES), SQUARES[-1])
    width = 2.0 * square * math.ceil(1.25 * reach / square)
    return scene.add_grid(
        "/ground",
        width=width,
        height=width,
        cell_size=square,
        section_size=5.0 * square,
        cell_color=(175, 175, 175),
        section_color=(130, 130, 130),
        shadow_opacity=0.0,
    )


def place_camera(server: Any, points: Array) -> None:
    """Set the first view of pages so that points (k, 3) (m) fill the picture."""
    eye, camera = fitted_camera(points), server.initial_camera
    camera.fov = FIELD
    camera.position, camera.look_at = eye.position, eye.look_at


def fit_camera(client: Any, points: Array) -> None:
    """Fill a browser (viser.ClientHandle) with points (k, 3) (m) from its present direction."""
    camera = client.camera
    backwards = camera.position - camera.look_at
    eye = fitted_camera(points, fov=camera.fov, aspect=camera.aspect, backwards=backwards)
    with client.atomic():
        camera.position = eye.position
        camera.look_at = eye.look_at


def set_theme(gui: Any, dark: bool) -> None:
    """Draw pages dark or light, without links to other sites."""
    gui.configure_theme(
        control_width="large", dark_mode=dark, show_logo=False, show_share_button=False
    )
