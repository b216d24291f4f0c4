"""Stereo matchers: infrared pairs in, disparities of the left image out; and the presets of RealSense cameras."""
