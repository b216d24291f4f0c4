"""The page of a comparison: its tables, figures and sentences."""
