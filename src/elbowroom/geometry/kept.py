"""Values that are worked out once for an object and kept for as long as it lives."""

from collections.abc import Callable, Hashable
from functools import wraps
from threading import RLock
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Owner = TypeVar("Owner")
Value = TypeVar("Value")
Key = ParamSpec("Key")


def kept(make: Callable[Concatenate[Owner, Key], Value]) -> Callable[Concatenate[Owner, Key], Value]:
    """Decorates a function of an object and of what else can be hashed; all arguments are given by position.

    Threads that ask at the same time wait for one of them to make the value. Objects are told apart as a dictionary
    does; a value that holds its own object keeps it alive.
    """
    values: WeakKeyDictionary[Any, dict[Hashable, Value]] = WeakKeyDictionary()
    making = RLock()

    @wraps(make)
    def known(owner: Owner, /, *key: Key.args, **none: Key.kwargs) -> Value:
        with making:
            own = values.setdefault(owner, {})
            if key not in own:
                own[key] = make(owner, *key, **none)
            return own[key]

    return known
