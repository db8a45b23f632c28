"""Inverse kinematics through an equivalent arm without coupled or missing joints."""
