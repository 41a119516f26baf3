"""What all blocks of a robot file have in common: strictness, and the types of their values."""

from collections.abc import Mapping
from typing import Annotated, Any, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

Seconds: TypeAlias = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Number: TypeAlias = Annotated[float, Field(allow_inf_nan=False)]


class SettingsBlock(BaseModel):
    """A block of settings: strict, frozen, without unknown keys.

    The texts below its attributes are read by `docs.generate`.
    """

    # Nearly all blocks are only read as a part of the whole file, whose validator has theirs.
    model_config = ConfigDict(defer_build=True, strict=True, extra="forbid", frozen=True)


def bare_names(named: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is named, without the leading slashes that names have in ROS.

    Raises:
        ValueError: A name occurs both with and without one.
    """
    found: dict[str, Any] = {}
    for name, value in named.items():
        bare = name.lstrip("/")
        if bare in found:
            raise ValueError(f"{bare} is named twice, with and without a leading slash")
        found[bare] = value
    return found
