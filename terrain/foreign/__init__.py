"""Files that others made, read in a child process with limits on memory and time.

A damaged file can keep a reader busy for minutes, ask it for all memory there is, or abort the
process from compiled code, which no `except` catches. So the readers here run in a child, import
little, and hand arrays back through a temporary file. Nothing in this package is imported by its
name alone: the child must start fast.
"""
