"""Optical constants at 850 nm, surface finishes, and the materials made of them."""
