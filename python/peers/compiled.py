"""The testers that have no package for Python: compiled once, from the folders `embree` and `parry`, into `target/peers`.

`build(tester)` says why one is not there: what is missing, and how Debian calls it.
"""

from __future__ import annotations

import ctypes
import importlib.machinery
import importlib.util
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
FOLDER = HERE.parents[1] / "target" / "peers"
EMBREE = FOLDER / "libpeer_embree.so"
PARRY = FOLDER / "release" / "libpeer_parry.so"


def succeed(command: list[str]) -> None:
    """Runs a compiler. Its last error is the reason of a failure."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if "error" in line]
        raise OSError((errors or done.stderr.splitlines() or [f"{command[0]} ended with {done.returncode}"])[0].strip())


def build_embree() -> None:
    compiler = shutil.which("c++")
    if compiler is None:
        raise OSError("no compiler of C++ (Debian's g++)")
    for header, package in (("embree3/rtcore.h", "libembree-dev"), ("CGAL/version.h", "libcgal-dev")):
        if not any((Path(folder) / header).is_file() for folder in ("/usr/include", "/usr/local/include")):
            raise OSError(f"{header} is not installed (Debian's {package})")
    source = HERE / "embree" / "embree.cpp"
    if EMBREE.is_file() and EMBREE.stat().st_mtime > source.stat().st_mtime:
        return
    FOLDER.mkdir(parents=True, exist_ok=True)
    # CGAL's interval arithmetic needs -frounding-math.
    options = ["-std=c++17", "-O3", "-DNDEBUG", "-frounding-math", "-fPIC", "-shared"]
    succeed([compiler, *options, str(source), "-o", str(EMBREE), "-lembree3", "-lgmp", "-lmpfr"])


def build_parry() -> None:
    if shutil.which("cargo") is None:
        raise OSError("cargo is not installed")
    manifest = HERE / "parry" / "Cargo.toml"
    succeed(["cargo", "build", "--release", "--locked", "--manifest-path", str(manifest), "--target-dir", str(FOLDER)])


BUILDS: dict[str, Callable[[], None]] = {"Embree": build_embree, "parry": build_parry}


def build(tester: str) -> str:
    """Compiles the library of a tester, whose name begins with the library's. Why it is skipped, or nothing."""
    make = BUILDS.get(tester.split(",")[0])
    try:
        if make is not None:
            make()
    except OSError as error:
        return f"skipped: {error}"
    return ""


def embree() -> Any:
    """The functions of `embree.cpp`."""
    library = ctypes.CDLL(str(EMBREE))
    library.peer_make.restype = ctypes.c_void_p
    library.peer_make.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64]
    library.peer_collide.restype = ctypes.c_int64
    library.peer_collide.argtypes = [ctypes.c_void_p, ctypes.c_int]
    library.peer_pairs.restype = ctypes.POINTER(ctypes.c_int64)
    library.peer_pairs.argtypes = [ctypes.c_void_p]
    library.peer_free.argtypes = [ctypes.c_void_p]
    return library


def embree_version(library: Any) -> str:
    """Versions of Embree and of CGAL, which their headers have as numbers: 31305 is 3.13.5, 1050511000 is 5.5.1."""
    number, of_cgal = library.peer_embree_version(), library.peer_cgal_version()
    cgal = f"{of_cgal // 10_000_000 % 100}.{of_cgal // 100_000 % 100}.{of_cgal // 10_000 % 10}"
    return f"{number // 10_000}.{number // 100 % 100}.{number % 100} (CGAL {cgal})"


def parry() -> Any:
    """The module of `parry/src/lib.rs`."""
    loader = importlib.machinery.ExtensionFileLoader("peer_parry", str(PARRY))
    spec = importlib.util.spec_from_file_location("peer_parry", PARRY, loader=loader)
    if spec is None:
        raise ImportError("peer_parry")
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def parry_version() -> str:
    """The version that the lock file of its folder names."""
    lock = (HERE / "parry" / "Cargo.lock").read_text(encoding="utf-8")
    found = re.search(r'name = "parry3d-f64"\nversion = "([^"]+)"', lock)
    return found[1] if found else ""
