"""The page of safe angles: a card per material."""
