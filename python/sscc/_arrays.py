"""Conversion of arguments to arrays, for the parts of the package that are written in Python."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def as_array(given: Any) -> NDArray[Any]:
    """Returns the same numbers as an array, without a copy if their memory allows that."""
    # NumPy treats an object that has only DLPack as a scalar.
    if hasattr(given, "__dlpack__") and not hasattr(given, "__array__"):
        return np.from_dlpack(given)
    return np.asarray(given)


def numbers(given: ArrayLike, name: str) -> NDArray[np.float64]:
    """Returns a copy as float64."""
    try:
        array = as_array(given)
    except ValueError as error:
        raise ValueError(f"{name}: an array of numbers was expected: {error}") from None
    except (BufferError, RuntimeError, TypeError) as error:
        raise TypeError(f"{name}: an array of numbers was expected: {error}") from None
    if array.dtype.kind not in "fiu" or isinstance(given, np.ma.MaskedArray):
        raise TypeError(f"{name} is a {type(given).__name__} of {array.dtype}: an array of numbers was expected")
    return array.astype(np.float64)


def check_finite(array: NDArray[np.float64], name: str) -> None:
    """Refuses NaN and infinities."""
    if not np.isfinite(array).all():
        place = [int(i) for i in np.argwhere(~np.isfinite(array))[0]]
        raise ValueError(f"{name}{place} is {array[tuple(place)]}: every entry must be finite")
