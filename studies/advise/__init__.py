"""Which of the remedies that people try on shiny metal helps on this part."""
