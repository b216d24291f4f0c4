"""Which materials and angles break the depth, the detector and the recovery, and why."""
