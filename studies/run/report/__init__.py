"""The page of one reconstruction."""
