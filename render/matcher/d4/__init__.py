"""The matcher that fails like the RealSense D4 chip, and its compiled loops."""
