"""Driving an arm by twists or joint rates: within limits, past singularities, whatever comes in."""
