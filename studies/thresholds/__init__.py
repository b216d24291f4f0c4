"""Thresholds with a guarantee: chosen for declared parts, certified, and watched on the real cell."""
