"""Functions that remember what they returned for the same content."""

from __future__ import annotations

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

_Given = ParamSpec("_Given")
_Made = TypeVar("_Made")


def recalled(
    most: int, content: Callable[..., Any] | None = None
) -> Callable[[Callable[_Given, _Made]], Callable[_Given, _Made]]:
    """Let a function return its former result where its arguments have the same content.

    What it returns is shared: nobody may write into it.

    Parameters
    ----------
    most : int
        Results that are kept; the one that was not asked for longest goes.
    content : callable, optional
        What of the arguments counts, if not all of them. It is pickled.
    """

    def remembering(make: Callable[_Given, _Made]) -> Callable[_Given, _Made]:
        kept: OrderedDict[bytes, _Made] = OrderedDict()
        lock = Lock()

        @wraps(make)
        def found(*args: _Given.args, **kwargs: _Given.kwargs) -> _Made:
            counts = (args, kwargs) if content is None else content(*args, **kwargs)
            key = hashlib.blake2b(pickle.dumps(counts, 5), digest_size=16).digest()
            with lock:
                if key in kept:
                    kept.move_to_end(key)
                    return kept[key]
            made = make(*args, **kwargs)
            with lock:
                kept[key] = made
                if len(kept) > most:
                    kept.popitem(last=False)
            return made

        return found

    return remembering
