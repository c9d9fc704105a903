"""A finished run opened in Python: its clouds, meshes, maps and waveforms for other libraries."""
