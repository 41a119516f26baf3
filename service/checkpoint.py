"""Checkpoints: the whole state of the core as bytes, for the same release of Pilothouse.

They are pickles, since the state of the core is whatever its concerns need. A pickle may come from
somebody else's folder, and so nothing is loaded but what a core consists of: classes of `domain`,
which has no I/O, their methods, containers, and arrays of numbers.
"""

import collections
import copyreg
import io
import pickle
import sys
from collections.abc import Callable, Mapping
from types import FunctionType, MappingProxyType, MethodType
from typing import Any

from domain.errors import PilothouseError, shortened
from domain.onboard import Onboard

_HEAD = b"pilothouse checkpoint "


class CheckpointError(PilothouseError):
    """A checkpoint that cannot be used: of another release, broken, or none at all."""

    code = "INVALID_CHECKPOINT"


def checkpoint_of(onboard: Onboard, version: str) -> bytes:
    """Return the state of a core; it goes on unchanged.

    Args:
        onboard: The core with its navigation.
        version: This release of Pilothouse.
    """
    text = io.BytesIO()
    text.write(_HEAD + version.encode() + b"\n")
    CorePickler(text, pickle.HIGHEST_PROTOCOL).dump(onboard)
    return text.getvalue()


def core_of_checkpoint(checkpoint: bytes, version: str) -> Onboard:
    """Return a core in the state of a checkpoint; it shares nothing with any other.

    Args:
        checkpoint: From `checkpoint_of`, or from anywhere.
        version: This release of Pilothouse.

    Raises:
        CheckpointError: Another release wrote it, or it holds anything but a core.
    """
    head, _, state = checkpoint.partition(b"\n")
    if not head.startswith(_HEAD):
        raise CheckpointError("this is no checkpoint")
    written_by = head.removeprefix(_HEAD).decode("utf-8", "replace")
    if written_by != version:
        words = f"release {shortened(written_by)} wrote this checkpoint; this is {version}"
        raise CheckpointError(words)
    try:
        core = _CoreUnpickler(state).load()
    except CheckpointError:
        raise
    except Exception as error:
        # A broken pickle raises whatever the objects in it raise.
        raise CheckpointError(f"the checkpoint is broken: {shortened(str(error))}") from error
    if not isinstance(core, Onboard):
        raise CheckpointError("the checkpoint holds no core")
    return core


def _reduce_view(view: MappingProxyType[Any, Any]) -> tuple[Callable[..., Any], tuple[Any]]:
    return view_of, (dict(view),)


def view_of(values: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Return a read-only view; pickle cannot find its type by name."""
    return MappingProxyType(values)


def _reduce_method(method: MethodType) -> tuple[Callable[..., Any], tuple[object, str]]:
    return method_of, (method.__self__, method.__name__)


def method_of(owner: object, name: str) -> MethodType:
    """Return a method of an object of the core.

    Raises:
        CheckpointError: It is of another object, or no method that the core defines.
    """
    kind = type(owner)
    function = getattr(kind, name, None)
    if (
        not isinstance(function, FunctionType)
        or not _is_of_domain(kind.__module__)
        or not _is_of_domain(function.__module__)
    ):
        raise CheckpointError(f"a checkpoint cannot hold {kind.__name__}.{shortened(name)}")
    return MethodType(function, owner)


class CorePickler(pickle.Pickler):
    """A pickler that also supports `MappingProxyType`, and writes methods as methods."""

    dispatch_table: Mapping[type, Callable[[Any], Any]] = {
        **copyreg.dispatch_table,
        MappingProxyType: _reduce_view,
        MethodType: _reduce_method,
    }


_ALLOWED: Mapping[tuple[str, str], object] = {
    (__name__, "view_of"): view_of,
    (__name__, "method_of"): method_of,
    ("builtins", "set"): set,
    ("builtins", "frozenset"): frozenset,
    ("collections", "deque"): collections.deque,
}
_NUMPY = frozenset(
    {
        ("numpy", "dtype"),
        ("numpy", "ndarray"),
        *(
            (f"numpy.{core}.{module}", name)
            for core in ("core", "_core")
            for module, name in (("numeric", "_frombuffer"), ("multiarray", "_reconstruct"))
        ),
    }
)
"""How numpy makes arrays again; the name of its core differs between its releases."""


class _CoreUnpickler(pickle.Unpickler):
    """An unpickler that finds nothing but what a core consists of."""

    def __init__(self, state: bytes) -> None:
        super().__init__(io.BytesIO(state))
        self._found: dict[type, dict[str, object]] = {}
        """Classes that were found, with their attributes as they were."""

    def find_class(self, module: str, name: str) -> object:
        """Return what a pickle names.

        Raises:
            CheckpointError: A core does not consist of such.
        """
        if (module, name) in _ALLOWED:
            return _ALLOWED[module, name]
        if (module, name) in _NUMPY:
            return super().find_class(module, name)
        # Only modules that are imported: to import one runs it.
        if _is_of_domain(module) and module in sys.modules:
            found = vars(sys.modules[module]).get(name)
            if isinstance(found, type) and found.__module__ == module:
                self._found.setdefault(found, dict(vars(found)))
                return found
        raise CheckpointError(f"a checkpoint cannot hold {shortened(f'{module}.{name}')}")

    def load(self) -> object:
        """Return what the pickle holds.

        Raises:
            CheckpointError: A core does not consist of such, or the pickle changes a class: its
                instructions can set attributes of whatever was found.
        """
        try:
            return super().load()
        finally:
            changed = [kind for kind, before in self._found.items() if _is_put_back(kind, before)]
            if changed:
                raise CheckpointError(f"a checkpoint cannot change {changed[0].__name__}")


def _is_put_back(kind: type, before: Mapping[str, object]) -> bool:
    """Give a class the attributes that it had, and tell whether any was changed."""
    changed = [name for name, value in vars(kind).items() if before.get(name) is not value]
    for name in changed:
        if name in before:
            setattr(kind, name, before[name])
        else:
            delattr(kind, name)
    return bool(changed)


def _is_of_domain(module: object) -> bool:
    return isinstance(module, str) and module.startswith("domain.")
