"""The command line, and the commands that are no study: doctor, frame, match, reconstruct, report."""
