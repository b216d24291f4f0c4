"""The dataset's card: what was drawn and what was measured."""
