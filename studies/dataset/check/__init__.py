"""Whether a dataset is what it says: every byte, label, pose and unit."""
