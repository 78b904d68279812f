"""The one doorway to numba.

numba's on-disk cache returns stale machine code when a helper in *another* file is edited. The cure
is a cache directory named by a hash of the package's sources: an edit anywhere makes a new one. It
is set only while our own kernels are decorated, because `numba.config.CACHE_DIR` is process-wide.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numba

_KEPT = 3  # cache directories of earlier sources that are kept (branches being switched between)


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode() + sys.version.encode())
    root = Path(__file__).parent
    for path in sorted(root.rglob("*.py")):
        text = path.read_bytes()
        if b"@kernel" in text:  # kernels see constants and helpers of such files only
            digest.update(str(path.relative_to(root)).encode() + text)
    return digest.hexdigest()[:16]


def _writable(path: Path) -> bool:
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return True
    except OSError:
        return False


def _cache_directory() -> Path:
    """Per-user directory, or a temporary one (said on stderr): never numba's silent `__pycache__`."""
    base = os.environ.get("FLOATSIM_CACHE_DIR")
    if base is None:
        base = str(Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "floatsim")
    path = Path(base) / f"kernels-{_source_hash()}"
    if _writable(path):
        old = sorted(Path(base).glob("kernels-*"), key=lambda item: item.stat().st_mtime, reverse=True)
        for item in old[_KEPT:]:
            if item != path:
                shutil.rmtree(item, ignore_errors=True)
        return path
    temporary = Path(tempfile.mkdtemp(prefix="floatsim-kernels-"))
    atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    print(
        f"floatsim: cannot write the kernel cache {path}; compiling into {temporary} for this process only "
        "(set FLOATSIM_CACHE_DIR to a writable directory)",
        file=sys.stderr,
    )
    return temporary


CACHE_DIRECTORY: Path = _cache_directory()


def cache_is_cold() -> bool:
    """True when nothing has been compiled yet for these sources on this machine."""
    return next(CACHE_DIRECTORY.rglob("*.nbi"), None) is None


def kernel(function: Callable[..., Any] | None = None, *, fastmath: bool | set[str] = False) -> Any:
    """Compile a scalar kernel on first call; division by zero gives inf as in NumPy.

    fastmath: LLVM's flags, none by default. {"reassoc", "contract"} lets long sums run in vector registers: their
    last digits then depend on the processor.
    """
    if function is None:
        return partial(kernel, fastmath=fastmath)
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    numba.config.CACHE_DIR = str(CACHE_DIRECTORY)  # type: ignore[attr-defined]
    try:
        return numba.njit(cache=True, error_model="numpy", fastmath=fastmath)(function)
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]
