"""Arms that carry the camera: a robot behind rosbridge, a UR, a person with a calibration board."""
