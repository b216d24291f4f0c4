"""Boxes, polygons, enclosing ellipsoids, mixtures and rays: what the planner computes with. Knows no map."""
