"""What ties the planner to real cameras (extra `realsense`), recordings (extra `record`) and arms, which need none.

What the extras bring is loaded when it is used, and not before.
"""
