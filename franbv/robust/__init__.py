"""fra-robust: a map that false depth cannot undo, views chosen by what succeeded in this run (docs/fra_robust.md)."""
