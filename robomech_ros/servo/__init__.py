"""Driving an arm by twists or joint rates, within all limits and past singularities."""
