"""Work on a cluster: a window of tasks, what becomes of failures, and how large bricks are."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distributed import Client, Future

Place = tuple[int, int, int]

# Edges of bricks that are tried where nobody says one, in cells.
EDGES = (512, 256, 128, 64, 32)
# Memory for a box of 32 cells along an edge that the surface crosses: its field, its vertices with
# their attributes, and its triangles, twice while they are written.
BOX_BYTES = 2 << 20
# The part of a worker's memory for one of its tasks at once.
SHARE = 0.3
# Bricks for each thread, so that all of them end at about the same time.
BRICKS = 12
# Tasks on their way for each thread of a worker: what workers and the client keep of them is bounded.
AHEAD = 3


class BrickError(RuntimeError):
    """A task has failed for good: its text names the scene and the brick, and the cause follows it.

    Attributes:
        scene: the name of the scene.
        place: the brick along x, y and z, or None where the task is none of a brick.
    """

    def __init__(self, text: str, scene: str = "", place: Place | None = None) -> None:
        super().__init__(text)
        self.scene = scene
        self.place = place

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.scene, self.place)


def client_of(client: Client | None) -> Client:
    """The client that is given, or the one that is there."""
    try:
        from distributed import Client, default_client
    except ImportError:
        raise ImportError("jbt.dask needs Dask: pip install 'jbt[dask]'") from None
    if client is None:
        try:
            found: Client = default_client()
        except ValueError:
            raise ValueError(
                "client: there is no client yet; distributed.Client() starts workers on this machine"
            ) from None
        return found
    if not isinstance(client, Client):
        raise TypeError(f"client: expected a distributed.Client, got {client!r}")
    if client.asynchronous:
        raise ValueError("client: expected one that is not asynchronous")
    return client


def workers(client: Client) -> tuple[int, int]:
    """Threads of all workers, and the memory for one task in bytes."""
    known = client.scheduler_info(n_workers=-1)["workers"].values()
    if not known:
        # A cluster that adapts starts workers for tasks alone.
        client.submit(int, 0, pure=False).result()
        known = client.scheduler_info(n_workers=-1)["workers"].values()
    threads = sum(worker["nthreads"] for worker in known)
    memory = [
        worker["memory_limit"] / max(1, worker["nthreads"]) for worker in known if worker["memory_limit"]
    ]
    return threads, int(SHARE * min(memory, default=8 << 30))


def edge_of(
    given: int | None, boxes: dict[Place, int], threads: int, memory: int, row_bytes: Callable[[int], int]
) -> int:
    """The edge of bricks: the largest with which every thread has a few, and with which the heaviest fits
    into the memory of a task.

    Args:
        given: what the user says.
        boxes: by the place of a box of 32 cells, how many bytes of rows reach it.
        row_bytes: the rows of a brick in bytes, from the sum over its boxes.
    """
    if given is not None:
        if given < 32 or given & (given - 1):
            raise ValueError(f"bricks: expected a power of two of cells, 32 or more, got {given}")
        return int(given)
    for edge in EDGES:
        weights: dict[Place, tuple[int, int]] = {}
        for (x, y, z), rows in boxes.items():
            side = edge // 32
            place = (x // side, y // side, z // side)
            count, sum_ = weights.get(place, (0, 0))
            weights[place] = (count + 1, sum_ + rows)
        heaviest = max((count * BOX_BYTES + row_bytes(rows) for count, rows in weights.values()), default=0)
        if (len(weights) >= BRICKS * threads or edge == EDGES[-1]) and heaviest <= memory:
            return edge
    return EDGES[-1]


@contextmanager
def cancelling(client: Client, futures: dict[Future, Any]) -> Iterator[None]:
    """Whatever is on its way when something goes wrong is cancelled."""
    try:
        yield
    except BaseException:
        client.cancel(list(futures), force=True)
        raise


class Window:
    """Tasks of bricks: as many on their way as keep all workers busy."""

    def __init__(
        self, client: Client, scene: str, retries: int, told: Callable[[float], object] | None
    ) -> None:
        self.client = client
        self.scene = scene
        self.retries = retries
        self.told = told

    def run(
        self,
        work: list[tuple[Place, int]],
        submit: Callable[[Place, int], Future],
        take: Callable[[Place, Any], int | None],
    ) -> None:
        """Submits a task for each brick and takes its result.

        Args:
            work: bricks, and how heavy they are.
            submit: the task of a brick, the how-manieth time.
            take: takes a result. If it says a number, the brick is asked again, for the so-manieth time.
        """
        from distributed import as_completed

        total, done = sum(weight for _, weight in work) or 1, 0
        waiting = [(place, weight, 0) for place, weight in reversed(work)]
        running: dict[Future, tuple[Place, int, int]] = {}
        completed: Any = as_completed(with_results=False)

        def fill() -> None:
            # Workers may come and go.
            most = AHEAD * max(1, sum(self.client.nthreads().values()))
            while waiting and len(running) < most:
                place, weight, again = waiting.pop()
                future = submit(place, again)
                running[future] = (place, weight, again)
                completed.add(future)

        with cancelling(self.client, running):
            if self.told is not None:
                self.told(0.0)
            fill()
            while running:
                future = next(completed)
                place, weight, _ = running.pop(future)
                try:
                    result = future.result()
                except Exception as error:
                    raise self.failed(place, error) from error
                finally:
                    future.release()
                asked = take(place, result)
                if asked is None:
                    done += weight
                    if self.told is not None:
                        self.told(done / total)
                else:
                    waiting.append((place, weight, asked))
                fill()

    def failed(self, place: Place, error: Exception) -> BrickError:
        what = str(error) or type(error).__name__
        return BrickError(f"{self.scene}: the brick {place} has failed: {what}", self.scene, place)


class Kept:
    """What a process makes once of bytes, and keeps: the last few."""

    def __init__(self, make: Callable[[Any], Any], most: int = 8) -> None:
        self._make = make
        self._most = most
        self._known: dict[Any, Any] = {}
        self._lock = threading.Lock()

    def __call__(self, key: Any) -> Any:
        with self._lock:
            found = self._known.pop(key, None)
            if found is None:
                found = self._make(key)
            self._known[key] = found
            while len(self._known) > self._most:
                self._known.pop(next(iter(self._known)))
            return found
