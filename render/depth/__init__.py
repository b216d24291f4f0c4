"""Disparity as 16-bit depth, decimated and cropped as librealsense does it."""
