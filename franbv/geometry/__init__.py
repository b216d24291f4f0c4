"""Boxes, enclosing ellipsoids, mixtures and rays: what the planner computes with and does not know a map."""
