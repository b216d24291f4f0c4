"""FRA-NBV: the planner. Depth in, poses out; it knows no simulator."""
