import os
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]
_Law = Callable[[_Array, _Array, _Array, float, float], npt.ArrayLike]  # u, K, N, elasticity, friction
_Sample = TrackerSample | MouseSample

class TrackerSample:
    def __init__(
        self,
        station: int,
        time_us: int,
        position: npt.ArrayLike,
        quaternion: npt.ArrayLike,
        buttons: int = 0,
        *,
        status: str = "",
        sequence: int = 0,
        host_time_us: int = 0,
        session_time_us: int = 0,
        sent_time_us: int = 0,
        position_estimated: bool = False,
        orientation_estimated: bool = False,
    ) -> None: ...
    @property
    def station(self) -> int: ...
    @property
    def time_us(self) -> int: ...
    @property
    def session_time_us(self) -> int: ...

class MouseSample:
    def __init__(
        self,
        time_us: int,
        left_thumb: bool = False,
        right_thumb: bool = False,
        trigger: bool = False,
        *,
        host_time_us: int = 0,
        session_time_us: int = 0,
    ) -> None: ...
    @property
    def time_us(self) -> int: ...
    @property
    def session_time_us(self) -> int: ...

class Session:
    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        response: str | int | _Law | None = None,
        sliding: str | None = None,
    ) -> None: ...
    def push(
        self,
        sample: _Sample
        | list[_Sample]
        | tuple[_Sample, ...]
        | npt.NDArray[np.void]
        | np.void,
    ) -> None: ...
    def step(self, count: int = 1) -> None: ...
    @property
    def tick(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def bodies(self) -> npt.NDArray[np.void]: ...
    @property
    def events(self) -> list[dict[str, Any]]: ...
    @property
    def score(self) -> dict[str, Any]: ...
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def response(self) -> str: ...
    @property
    def state_hash(self) -> str | None: ...
    @property
    def game_hash(self) -> str | None: ...
