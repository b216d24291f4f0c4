"""The bench of the paper, as its authors' photographs show it: plinth, table, task lamp, hall."""
