"""A planner on a real camera and arm, behind a guard that trusts neither."""
