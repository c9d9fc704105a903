"""Anybody's processed cloud against the truth of a run."""
