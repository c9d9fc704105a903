"""Who does the work of many frames: threads, processes, or the workers of a dask cluster."""
