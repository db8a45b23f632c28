"""What stands between our nodes and ROS: queues, requests and bytes, and signs of life."""
