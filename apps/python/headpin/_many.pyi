from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

def replay_many(
    trials: Any,  # a path or a Trial, or an iterable of them
    table: Mapping[str, Any] | Iterable[Mapping[str, Any]] | npt.NDArray[np.void] | Any,
    threads: int = 0,
    progress: Callable[[int, int], object] | Literal[False] | None = None,
) -> npt.NDArray[np.void]: ...
