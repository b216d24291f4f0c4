"""What a dataset's folder holds, and how it is read."""
