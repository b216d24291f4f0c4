"""Intervals, paired differences and pooled shares."""
