"""What tests share."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import jbt
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session", autouse=True)
def interrupts() -> Iterator[None]:
    """Ctrl-C is heard, even if the tests run in the background of a shell that ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def hero() -> jbt.Model:
    """The octopus of the README."""
    return jbt.load(ROOT / "examples" / "hero.jbt")


@pytest.fixture
def peanut() -> jbt.Model:
    """Two balls that grow together, each with its colour."""
    red = jbt.point((0, 0.4, 0), radius=1, color=(1, 0, 0))
    return red + jbt.point((0, -0.4, 0), radius=1, color=(0, 0, 1))


@pytest.fixture
def cloud() -> np.ndarray:
    """A thousand points around the peanut."""
    return np.random.default_rng(1).uniform(-1.2, 1.2, (1000, 3))
