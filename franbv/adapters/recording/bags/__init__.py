"""Recordings of ROS and librealsense, read without either."""
