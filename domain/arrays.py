"""numpy, loaded by what first uses it: a robot at rest needs none of it.

It takes 11 MB of the service's memory, and 0.1 s. Modules import `np` from here and use it as they
would numpy. Whoever runs an event loop calls `load_numpy` in a thread before, which holds up the
loop for some 10 ms (decision 64).

`importlib.util.LazyLoader` does the same; before Python 3.12, two threads that first use its module
at once may find it half loaded.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias

__all__ = ["Floats", "Integers", "is_numpy_loaded", "load_numpy", "np"]

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats: TypeAlias = NDArray[np.float64]
    Integers: TypeAlias = NDArray[np.int64]
else:
    # Annotations are evaluated when a module is imported, which must not load numpy.
    Floats = Integers = Any

    def _of_numpy(name: str) -> object:
        if name.startswith("__"):
            # It is no more than looked at, as by a debugger.
            raise AttributeError(f"numpy is not loaded for {name}")
        import numpy

        value = getattr(numpy, name)
        # Found like any other attribute from now on.
        setattr(np, name, value)
        return value

    # Not of a class with `__getattr__`: an attribute that is there would take 0.12 us instead of
    # 0.03, since the interpreter has its fast path for plain modules alone.
    np = ModuleType("numpy", "numpy, loaded by what first uses it.")
    np.__getattr__ = _of_numpy


def load_numpy() -> None:
    """Load numpy, unless it is loaded; threads may do so at the same time."""
    _ = np.ndarray


def is_numpy_loaded() -> bool:
    """Tell whether `load_numpy` has been called, and has ended."""
    return "ndarray" in vars(np)
