"""Adapters: real cameras behind `franbv.sensing`. Each loads what it needs when it is used, and not before."""
