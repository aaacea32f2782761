"""headpin: a headless immersive bowling simulator with a tracked-device layer."""

from . import engine
from ._headpin import __version__
from ._many import replay_many
from ._session import MouseSample, Session, TrackerSample

__all__ = ["MouseSample", "Session", "TrackerSample", "__version__", "engine", "replay_many"]
