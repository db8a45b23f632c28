"""The fingers of a gripper: commands to them, what they press on; knows neither ROS nor a clock."""
