"""Where the camera sits on the arm: a board of markers found in images, and the hand-eye calibration made of it."""
