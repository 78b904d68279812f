"""Fixtures for all tests."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # recorder and closed forms, wherever a test stands

from recorder import FILE, Recorder  # noqa: E402

import floatsim.study.store  # noqa: F401, E402  switches HDF5's file locking off before any test brings HDF5 up

_recorder = Recorder()


@pytest.fixture(scope="session")
def record() -> Recorder:
    """`record(check, quantity, measured, bar, unit="", holds=None)`, see tests/recorder.py."""
    return _recorder


def pytest_sessionfinish(session: pytest.Session) -> None:
    _recorder.write(session.config.rootpath / FILE)
