"""How far long work is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

#: Is called with what is being done, realizations done, how many there are, and the part of the work that is done, from 0 to 1.
Progress = Callable[[str, int, int, float], Any]


@contextmanager
def told(progress: bool | Progress | None) -> Iterator[Progress | None]:
    """What the library calls: a bar of tqdm for True (nothing where tqdm is not installed), or what was given."""
    if callable(progress):
        yield progress
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    bar = tqdm(total=1.0, bar_format="{l_bar}{bar}| {elapsed}<{remaining}{postfix}", leave=False)

    def tell(stage: str, done: int, total: int, share: float) -> None:
        bar.set_description(stage, refresh=False)
        bar.set_postfix_str(f"{done} of {total}", refresh=False)
        bar.update(max(0.0, min(share, 1.0) - bar.n))

    try:
        yield tell
    finally:
        bar.close()
