"""The arm that carries the camera: reach, collisions, times."""
