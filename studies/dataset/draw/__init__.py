"""Random scenes: what is drawn, where it lies, what it is made of."""
