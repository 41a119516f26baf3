"""All codes."""

from collections.abc import Mapping
from types import MappingProxyType

from service.finding_codes.file_codes import ALL_FILES, ROBOT_FILES, WAYPOINT_FILES
from service.finding_codes.finding_code import FindingCode
from service.finding_codes.model_codes import MODES, PARTS, RULES, YAML
from service.finding_codes.settings_codes import CONDITIONS, ERRORS, REACTIONS, SETTINGS

OF_MODELS = (*YAML, *PARTS, *MODES, *RULES, *SETTINGS, *ERRORS, *REACTIONS, *CONDITIONS)

FINDING_CODES: Mapping[str, FindingCode] = MappingProxyType(
    {own.code: own for own in (*OF_MODELS, *ROBOT_FILES, *WAYPOINT_FILES, *ALL_FILES)}
)
