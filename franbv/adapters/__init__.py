"""What ties the planner to real cameras, arms and recordings; each part needs an extra, and none is loaded unasked."""
