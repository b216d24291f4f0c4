"""One reconstruction from many starts: the runs, what they reached together, and the page over them."""
