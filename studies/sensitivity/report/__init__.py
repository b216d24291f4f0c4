"""The page of a sensitivity study."""
