"""The documentation site: the pages that the code itself tells, and formulas drawn at build."""
