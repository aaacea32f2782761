"""headpin: a headless immersive bowling simulator with a tracked-device layer.

    import headpin
    t = headpin.Trial("trial.lcmlog")     # samples, events, states: arrays of numpy
    r = t.replay(friction=0.1)            # simulated again under another condition
    f = t.frames(250, depth=True)         # what an eye saw
    s = headpin.Session("uno-slater-1997")  # step by step, with samples of one's own

`headpin.replay_many` makes many replays, and `headpin.engine` has worlds, shapes and bodies alone.
Lengths are in metres, times in seconds, angles in radians, quaternions are w, x, y, z.
"""

from . import engine
from ._headpin import DamagedTrial, Frame, Replay, Trial, __version__
from ._many import replay_many
from ._session import MouseSample, Session, TrackerSample

replay_many.__module__ = __name__  # where its users find it

__all__ = [
    "DamagedTrial", "Frame", "MouseSample", "Replay", "Session", "TrackerSample", "Trial", "__version__", "engine",
    "replay_many",
]
