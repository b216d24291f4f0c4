"""What was found against what is true: detection, regions, recovery, missing surface, matches."""
