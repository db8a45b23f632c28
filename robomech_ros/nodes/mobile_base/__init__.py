"""The node `mobile_base`: a rolling robot that follows commands of its twist."""
