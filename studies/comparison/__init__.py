"""FRA-NBV against PB-NBV and ray-cast entropy, beside the paper's numbers."""
