"""The controller: follows trajectories, joins, holds, slows down; knows neither ROS nor a clock."""
