"""Scenes made: rendered, labelled and written in BOP's layout."""
