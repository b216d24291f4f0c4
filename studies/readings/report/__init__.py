"""The page of a study of readings."""
