"""Layer between our nodes and ROS: queues, requests and bytes, and liveliness."""
