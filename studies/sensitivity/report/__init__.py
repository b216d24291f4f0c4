"""The page of a sensitivity study: its maps, figures and tables."""
