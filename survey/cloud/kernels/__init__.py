"""Compiled loops of the ranging."""
