"""Runs as pictures in the viewer rerun: live while they last, or as a file; nothing of it is loaded unasked."""
