"""What a flight will come to, before any light is traced: `bathyflash plan`."""
