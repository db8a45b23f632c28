"""Words that newcomers search for, by the page that answers them."""

WORDS = {
    "real_robot": ("real robot", "my robot", "UR", "driver", "ros2_control", "remapping"),
    "moveit": ("MoveIt", "pymoveit2", "MoveGroupInterface"),
    "tool": ("tool", "TCP", "tool centre point", "tool center point"),
    "grippers": ("gripper",),
    "limits": ("limits", "joint limits", "velocity limits"),
    "collisions": ("collisions", "obstacles", "self-collisions"),
    "several_robots": ("several robots", "two robots", "multiple robots", "namespace"),
    "distributions": ("ROS distributions", "Humble", "Jazzy", "Kilted", "Rolling"),
    "docker": ("Docker", "container"),
    "platforms": ("platforms", "aarch64", "ARM", "macOS", "Windows"),
    "citing": ("citing", "cite", "citation"),
}
