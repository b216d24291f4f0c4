"""Recordings of runs: written while they last, read back, replayed without a robot."""
