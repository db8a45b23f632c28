"""The node calibration."""
