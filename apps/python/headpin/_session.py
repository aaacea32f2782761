"""A session, tick by tick."""

from ._headpin import MouseSample, Session, TrackerSample

__all__ = ["MouseSample", "Session", "TrackerSample"]
