"""Codes of model files but for their settings."""

from service.finding_codes.finding_code import EITHER, ERROR, WARNING, FindingCode

YAML = (
    FindingCode(
        "YAML_SYNTAX",
        ERROR,
        "The file is not YAML, or not text. The rest was not checked.",
        "Check this position and the line before it: brackets, quotes, tabs, indentation.",
    ),
    FindingCode(
        "ALIAS",
        ERROR,
        "`*name`. C++ rejects these too.",
        "Repeat the value.",
    ),
    FindingCode(
        "MERGE_KEY",
        ERROR,
        "`<<:` merges another map.",
        "Repeat the keys.",
    ),
    FindingCode(
        "DUPLICATE_KEY",
        ERROR,
        "A key, part, mode or parameter occurs twice, perhaps once with a slash or a dot. C++ "
        "takes the later value.",
        "Remove one.",
    ),
    FindingCode(
        "INVALID_KEY",
        ERROR,
        "A key is empty, or a list or map.",
        "Use a name.",
    ),
    FindingCode(
        "EMPTY_VALUE",
        ERROR,
        "A key without a value, `[]` or `{}`. C++ rejects these too.",
        "Leave the key out, or write `''` for an empty string.",
    ),
    FindingCode(
        "INVALID_ARRAY",
        ERROR,
        "A list holds values of several types, or lists or maps. `y`, `n`, `on`, `off`, `yes` "
        "and `no` are booleans.",
        "Use one type; quote strings.",
    ),
    FindingCode(
        "TOO_DEEP",
        ERROR,
        "More than 64 nested maps and lists, or more than 64 levels of systems below a system.",
        "Flatten it.",
    ),
    FindingCode(
        "TOO_LARGE",
        ERROR,
        "More than 2,000,000 keys and values; as many lines in all modes, including inherited "
        "lines from `__DEFAULT__`; more than 100 `%TAG` directives; parts with 1,000,000 "
        "systems above them together; more than 10,000 lines in the extensions of a part, "
        "including those of aliases; or more than 50 conditions in a list.",
        "Split the model.",
    ),
)

PARTS = (
    FindingCode(
        "NOT_A_BLOCK",
        ERROR,
        "A value where a block of keys is expected: the document, `ros__parameters`, `modes`, "
        "a mode, `rules`, a rule.",
        "Write the keys below it, indented.",
    ),
    FindingCode(
        "MISSING_ROS_PARAMETERS",
        ERROR,
        "A part without `ros__parameters`, or a mode of a node with values outside "
        "`ros__parameters`. C++ reads the latter as states of parts.",
        "Insert `ros__parameters:`.",
    ),
    FindingCode(
        "MISPLACED_KEY",
        ERROR,
        "`ros__parameters` without a name above it, or followed by another part in the same "
        "map; C++ loses the namespace of that part.",
        "Put the part before `ros__parameters`, or at the top level with its full name.",
    ),
    FindingCode(
        "INVALID_NAME",
        ERROR,
        "The name is not a valid ROS 2 name, or is a wildcard.",
        "Use letters, digits and underscores, not starting with a digit; separate namespaces "
        "with slashes.",
    ),
    FindingCode(
        "RESERVED_NAME",
        ERROR,
        "The last word of the name is `state`, `states`, `mode`, `modes` or `parameters`, "
        "which have a meaning in URLs.",
        "Use another name.",
    ),
    FindingCode(
        "MISSING_TYPE",
        ERROR,
        "No `type`. C++ drops the part silently.",
        "Add `type: node` or `type: system`.",
    ),
    FindingCode(
        "UNKNOWN_TYPE",
        WARNING,
        "A type other than `node` and `system`; treated as a system, as in C++.",
        "Write `system`, or `node` if intended.",
    ),
    FindingCode(
        "NO_PARTS",
        WARNING,
        "A system without modes, and so without parts; or an empty model.",
        "Add `modes` with `__DEFAULT__`.",
    ),
    FindingCode(
        "CYCLE",
        ERROR,
        "A system contains itself, directly or through others. C++ crashes.",
        "Remove the part at this position.",
    ),
    FindingCode(
        "PARTS_DIFFER",
        WARNING,
        "The list under `parts` differs from the keys of `__DEFAULT__`. Only the latter count.",
        "Make them equal, or leave `parts` out.",
    ),
)

MODES = (
    FindingCode(
        "MISSING_DEFAULT_MODE",
        ERROR,
        "There are modes, but no `__DEFAULT__`. Unlike in C++, it may be at any position.",
        "Add it.",
    ),
    FindingCode(
        "DOTTED_NAME",
        ERROR,
        "A mode, or a part in a mode, has a dot in its name, or a namespace is written as a "
        "map there. C++ truncates the name.",
        "Do not use dots; write `left/arm` for an arm in the namespace left.",
    ),
    FindingCode(
        "PARAMETER_NOT_IN_DEFAULT",
        ERROR,
        "A mode sets a parameter that `__DEFAULT__` does not have.",
        "Add it to `__DEFAULT__`.",
    ),
    FindingCode(
        "PARAMETERS_OF_A_SYSTEM",
        ERROR,
        "A mode of a system holds `ros__parameters`.",
        "Did you mean `type: node`?",
    ),
    FindingCode(
        "UNKNOWN_PART",
        ERROR,
        "A mode, rule, setting or condition names a part that is not in the model, or "
        "`sequence` or `after` one that is not in the system. C++ crashes on a request for a "
        "mode with an unknown part.",
        "Correct the name; parts in namespaces need their full name.",
    ),
    FindingCode(
        "UNKNOWN_MODE",
        ERROR,
        "A mode, rule, setting or condition names a mode that the part does not have, or a "
        "part without modes has `mode_settings`.",
        "Correct it; the message lists the modes.",
    ),
    FindingCode(
        "UNKNOWN_STATE",
        ERROR,
        "Not a lifecycle state; these are lower case. C++ treats it as unknown.",
        "`active`, `inactive`, `unconfigured`, `finalized`.",
    ),
    FindingCode(
        "TRANSITIONAL_STATE",
        WARNING,
        "A mode requires a transition state, such as `activating`.",
        "Name the state that it leads to.",
    ),
    FindingCode(
        "INERT_MODE",
        WARNING,
        "A mode with a state other than active, such as `inactive.FAST`.",
        "Leave the mode out.",
    ),
    FindingCode(
        "PART_NOT_IN_DEFAULT",
        WARNING,
        "A mode names a part that `__DEFAULT__` does not, so it does not count as part of the "
        "system.",
        "Add it to `__DEFAULT__`.",
    ),
    FindingCode(
        "LEADING_SLASH",
        WARNING,
        "`/left/arm` in a mode or rule; read as `left/arm`. C++ finds no such part.",
        "Remove the slash.",
    ),
    FindingCode(
        "MODES_ALIKE",
        WARNING,
        "Two modes of a part are identical, or name modes of a part that are; the requested "
        "one is inferred, or else the first.",
        "Give one parameter different values.",
    ),
    FindingCode(
        "TYPE_DIFFERS",
        WARNING,
        "A parameter has another type than in `__DEFAULT__`, such as 1 and 1.0. A node accepts "
        "at most one of them.",
        "Use the same type in both.",
    ),
    FindingCode(
        "NEVER_INFERRED",
        WARNING,
        "A parameter is not a number (`.nan`). It never compares equal, so no mode with it can "
        "be inferred from parameters.",
        "Use a number.",
    ),
    FindingCode(
        "CONFLICTING_SYSTEMS",
        WARNING,
        "A part belongs to two systems that can require different states or modes of it at the "
        "same time.",
        "Give the part to one of them, or make their modes compatible.",
    ),
)

RULES = (
    FindingCode(
        "INCOMPLETE_RULE",
        ERROR,
        "One of `if_target`, `if_part` and `new_target` is missing. In C++, the rule never "
        "takes effect.",
        "Add it.",
    ),
    FindingCode(
        "UNKNOWN_RULE_KEY",
        ERROR,
        "Another key in a rule. C++ rejects these too.",
        "Remove it.",
    ),
    FindingCode(
        "INVALID_RULE",
        EITHER,
        "`if_part` is not a list of a part and a state; C++ crashes on a list of one item. As "
        "a warning: the list has further items, which are ignored.",
        "`if_part: [drive_base, inactive]`",
    ),
    FindingCode(
        "RULES_OF_A_NODE",
        WARNING,
        "A node has rules. They only take effect in systems.",
        "Move them to the system.",
    ),
    FindingCode(
        "RULE_CIRCLE",
        WARNING,
        "Rules lead from a target back to the same target, so they can undo each other or the "
        "request.",
        "Let rules lead in one direction; the target is restored when the cause is gone.",
    ),
    FindingCode(
        "RULE_UNDOES_REQUEST",
        WARNING,
        "A rule gives up a target while a part is in the state that the target requires, of "
        "its parts or further down.",
        "Name the state in which the part fails.",
    ),
)
