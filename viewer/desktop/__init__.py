"""A window to fly a finished run in."""
