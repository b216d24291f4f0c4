"""A contact sheet and statistics of a dataset."""
