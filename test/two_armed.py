"""A torso that turns, two arms of six joints on it, and a hand at the left one; our own numbers."""

__all__ = ["SRDF", "URDF", "joints_of"]

_AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")
_PLACES = ("0 0 0.2", "0 0 0.1", "0.3 0 0", "0.1 0 0", "0.2 0 0", "0.1 0 0")
_HOME = (0.1, -0.4, 0.9, 0.2, -0.7, 0.3)


def joints_of(side):
    """Name the joints of an arm, base to tip."""
    return tuple(f"{side}_joint_{i}" for i in range(1, 7))


def _joint(name, kind, parent, child, at, axis="0 0 1", limit=(-3.0, 3.0)):
    moves = f'<axis xyz="{axis}"/>' + (
        f'<limit lower="{limit[0]}" upper="{limit[1]}" velocity="2" effort="10" '
        'acceleration="8" jerk="80"/>'
    )
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}"/>{"" if kind == "fixed" else moves}</joint>'
    )


def _arm(side, y):
    parts = [_joint(f"{side}_mount", "fixed", "torso", f"{side}_base", f"0 {y} 0.5")]
    links = [f"{side}_base", *(f"{side}_link_{i}" for i in range(1, 7))]
    for i, name in enumerate(joints_of(side)):
        parts.append(_joint(name, "revolute", links[i], links[i + 1], _PLACES[i], axis=_AXES[i]))
    parts.append(_joint(f"{side}_end", "fixed", links[-1], f"{side}_tool", "0.1 0 0"))
    return [*links, f"{side}_tool"], "".join(parts)


def _urdf():
    left, left_joints = _arm("left", 0.3)
    right, right_joints = _arm("right", -0.3)
    links = ["world", "torso", *left, *right, "finger", "thumb"]
    return (
        '<robot name="two_armed" version="1.2">'
        + "".join(f'<link name="{name}"/>' for name in links)
        + _joint("torso_joint", "revolute", "world", "torso", "0 0 0.4")
        + left_joints
        + right_joints
        + _joint("finger_joint", "prismatic", "left_tool", "finger", "0 0.02 0", "0 1 0", (0, 0.04))
        + _joint("thumb_joint", "prismatic", "left_tool", "thumb", "0 -0.02 0", "0 1 0", (-0.04, 0))
        + "</robot>"
    )


def _state(name, group, positions):
    joints = "".join(f'<joint name="{j}" value="{v}"/>' for j, v in positions.items())
    return f'<group_state name="{name}" group="{group}">{joints}</group_state>'


def _home(side, sign):
    return {name: sign * value for name, value in zip(joints_of(side), _HOME, strict=True)}


URDF = _urdf()
SRDF = (
    '<robot name="two_armed">'
    '<group name="left_arm"><chain base_link="left_base" tip_link="left_tool"/></group>'
    '<group name="right_arm"><chain base_link="right_base" tip_link="right_tool"/></group>'
    '<group name="hand"><joint name="finger_joint"/><joint name="thumb_joint"/></group>'
    '<group name="both"><group name="left_arm"/><group name="right_arm"/></group>'
    '<end_effector name="hand" parent_link="left_tool" group="hand" parent_group="left_arm"/>'
    + _state("home", "left_arm", _home("left", 1.0))
    + _state("home", "right_arm", _home("right", -1.0))
    + _state("far", "left_arm", _home("left", 1.0) | {"left_joint_1": 3.5})
    + _state("open", "hand", {"finger_joint": 0.03, "thumb_joint": -0.03})
    + _state("home", "hand", {"finger_joint": 0.02, "thumb_joint": -0.01})
    + "</robot>"
)
