"""How far the ground reaches, and how finely: what lies beyond is a fault of the input."""

HIGHEST = 12_000.0
"""Above or below the datum [m]: no ground is higher or deeper."""
FARTHEST = 1e8
"""From the origin of a map [m], zone numbers before eastings included."""
MOST_CELLS = 20_000_000
"""Of a raster or a made seabed, so that its mesh stays in memory."""
MOST_BOULDERS = 20_000
"""Of a field."""
