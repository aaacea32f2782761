"""headpin: a headless immersive bowling simulator with a tracked-device layer."""

from ._headpin import __version__

__all__ = ["__version__"]
