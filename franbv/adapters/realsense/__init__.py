"""A RealSense camera of the D400 family through librealsense, as a `DepthCamera`."""
