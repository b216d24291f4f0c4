"""What a command line gives by name: one of ours, or a function of anybody's, `package.module:function`."""

import importlib
from collections.abc import Callable, Mapping
from typing import Any


def named_function(
    what: str, name: str, own: Mapping[str, str], choices: str, fault: type[Exception]
) -> Callable[..., Any]:
    """The function; its module is loaded now. own: where each of ours is; choices: what to say where there is none.

    fault is raised, in one line, where there is no such function.
    """
    module, _, function = own.get(name, name).partition(":")
    if not function:
        raise fault(f"{what} {name}: unknown; choose {choices}, or package.module:function")
    try:
        return getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        raise fault(f"{what} {name}: cannot be loaded ({error}); name a function that can be imported") from None
