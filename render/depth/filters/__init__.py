"""librealsense's post-processing of depth, bit for bit.

Our own code after librealsense's sources (Apache License 2.0, Intel Corporation and RealSense Inc.), `src/proc/*.cpp`
and `*.h`; checked against pyrealsense2 2.59.1.
"""
