"""Who is told how far work is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ._types import Progress


@contextmanager
def watcher(progress: Progress, what: str) -> Iterator[Callable[[float], object] | None]:
    """A callable for the native module: of a callable itself, of True or of a bar of tqdm its updates."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from None
        with tqdm(total=1.0, desc=what, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}") as bar:
            yield updates(bar)
    elif hasattr(progress, "update") and hasattr(progress, "n"):
        yield updates(progress)
    elif callable(progress):
        yield progress
    else:
        raise TypeError(f"progress: expected a callable, True or a bar of tqdm, got {progress!r}")


def updates(bar: Any) -> Callable[[float], object]:
    total = bar.total if bar.total else 1.0

    def told(part: float) -> None:
        bar.update(part * total - bar.n)

    return told
