"""The JSON Schema of robot files; what each key means is told by the text below its attribute.

pydantic could read these texts as well, but then it would parse the source of all blocks at every
start of the service, which describes them to nobody.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonRef, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema

from service.files.robot_file import RobotSettings
from service.files.settings_block import SettingsBlock


def robot_schema() -> dict[str, Any]:
    """Return the schema."""
    return RobotSettings.model_json_schema(schema_generator=_Described)


class _Described(GenerateJsonSchema):
    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        """Return the schema of a block."""
        found, block = super().model_schema(schema), schema["cls"]
        for kind in block.__mro__:
            if issubclass(kind, SettingsBlock):
                for name, words in _texts(kind):
                    key = block.model_fields[name].alias or name
                    member = found["properties"][key]
                    if words != self._words_of_block(member):
                        member.setdefault("description", words)
        return found

    def _words_of_block(self, member: JsonSchemaValue) -> str | None:
        """Return what a block says of itself; None: the member is none."""
        if "$ref" not in member:
            return None
        block = self.get_schema_from_definitions(JsonRef(member["$ref"]))
        return None if block is None else block.get("description")


def _texts(kind: type[SettingsBlock]) -> Iterator[tuple[str, str]]:
    """Yield the attributes that a block declares itself, each with the text below it."""
    (block,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
    assert isinstance(block, ast.ClassDef)
    for declared, below in pairwise(block.body):
        match declared, below:
            case (
                ast.AnnAssign(target=ast.Name(id=key)),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                yield key, inspect.cleandoc(text)
