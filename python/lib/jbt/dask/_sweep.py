"""One model with many values of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import product
from typing import Any

from .._model import Model
from . import _work


def sweep(
    model: Model,
    parameters: Mapping[str, Iterable[float]] | Iterable[Mapping[str, float]],
    what: str | Iterable[str] | Callable[[Model], Any] = "volume",
    *,
    partitions: int | None = None,
) -> Any:
    """What is asked of a model, for many values of its parameters: a `dask.bag` of dictionaries, with the
    parameters and the answers. `.to_dataframe()` makes a dataframe of it, `.compute()` a list.

    Args:
        model: its text is shipped, and each worker reads and compiles it once.
        parameters: values for each name, of which all combinations are taken; or the combinations.
        what: names of properties, as "volume", "area" and "bounds"; or a function of a model, whose value is
            called "result".
        partitions: into how many parts the work is divided.
    """
    from dask import bag

    if isinstance(parameters, Mapping):
        lists = {name: [float(value) for value in values] for name, values in parameters.items()}
        rows = [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]
    else:
        rows = [{name: float(value) for name, value in row.items()} for row in parameters]
    if not rows:
        raise ValueError("parameters: expected at least one value, got none")
    unknown = sorted({name for row in rows for name in row} - set(model.parameters))
    if unknown:
        known = ", ".join(model.parameters) or "none"
        raise ValueError(f"parameters: the model has no {', '.join(unknown)}; it has {known}")
    words = what if callable(what) else [what] if isinstance(what, str) else list(what)
    if not callable(words):
        wrong = [
            word
            for word in words
            if word.startswith("_") or not isinstance(getattr(Model, word, None), property)
        ]
        if wrong:
            raise ValueError(
                f"what: expected properties of a model, as volume, area or bounds, got {wrong[0]!r}"
            )
    parts = partitions or min(len(rows), 100)
    text = str(model)
    return bag.from_sequence(rows, npartitions=parts).map(_measured, text, words)


def _measured(parameters: dict[str, float], text: str, what: Any) -> dict[str, Any]:
    return _work.measured(text, parameters, what)
