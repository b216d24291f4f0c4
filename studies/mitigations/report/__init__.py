"""The page of a study of mitigations."""
