"""Which remedy for shiny metal wins where: what `franbv advise` tries on a part, tried over the catalogue's metals."""
