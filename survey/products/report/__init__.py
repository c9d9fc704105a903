"""The report of a run: a page in one file without a network, and its figures beside it."""
