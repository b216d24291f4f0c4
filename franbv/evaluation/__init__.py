"""How much of the object a run has reconstructed, and how well, against a known surface (paper, section VI)."""
