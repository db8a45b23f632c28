"""A UR5e with simple shapes around its links, and meshes of boxes."""

from __future__ import annotations

from robomech_ros.robots import load_description

# Link to the shapes around it: capsule-like cylinders along x, and balls; lengths in m.
_SHAPES = {
    "base_link": ['<origin xyz="0 0 0.04"/><geometry><cylinder radius="0.075" length="0.08"/>'],
    "shoulder_link": ['<geometry><sphere radius="0.075"/>'],
    "upper_arm_link": [
        '<origin xyz="-0.2125 0 0.138" rpy="0 1.5707963267948966 0"/>'
        '<geometry><cylinder radius="0.06" length="0.425"/>'
    ],
    "forearm_link": [
        '<origin xyz="-0.196 0 0.016" rpy="0 1.5707963267948966 0"/>'
        '<geometry><cylinder radius="0.05" length="0.392"/>'
    ],
    "wrist_1_link": ['<geometry><sphere radius="0.05"/>'],
    "wrist_2_link": ['<geometry><sphere radius="0.05"/>'],
    "wrist_3_link": ['<origin xyz="0 0 -0.03"/><geometry><sphere radius="0.04"/>'],
}


def shaped_ur5e(acceleration: float | None = None) -> str:
    """Return the URDF of a UR5e whose links have shapes, and its joints this limit (rad/s^2)."""
    from pathlib import Path

    text = Path(load_description("ur5e").where).read_text(encoding="utf-8")
    for link, shapes in _SHAPES.items():
        elements = "".join(f"<collision>{shape}</geometry></collision>" for shape in shapes)
        empty, filled = f'<link name="{link}"/>', f'<link name="{link}">'
        if empty in text:
            text = text.replace(empty, f"{filled}{elements}</link>")
        else:
            assert filled in text, link
            text = text.replace(filled, f"{filled}{elements}")
    if acceleration is not None:
        text = text.replace("<limit ", f'<limit acceleration="{acceleration}" ')
    return text
