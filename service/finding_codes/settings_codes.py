"""Codes of the settings of modes and of conditions."""

from service.finding_codes.finding_code import EITHER, ERROR, WARNING, FindingCode

SETTINGS = (
    FindingCode(
        "UNKNOWN_KEY",
        ERROR,
        "A key of `mode_settings` or of a robot file does not exist. Under `signals` of a "
        "robot file, an unknown name declares an additional signal, so the finding is about "
        "the keys below it.",
        "Correct the name.",
    ),
    FindingCode(
        "INVALID_VALUE",
        ERROR,
        "Wrong type, out of range, or a threshold that can never be reached or is on the wrong "
        "side of the clear threshold. In `mode_settings`, times are at most a day (86,400 s).",
        "See the message.",
    ),
    FindingCode(
        "NOT_FOR_CPP",
        WARNING,
        "C++ would reject or misread the file: a null, an alias, an empty list or map, a list "
        "of maps or of several types beside `modes`; or a name that ends in `modes` or "
        "`rules`, which C++ takes for these blocks.",
        "Leave it out, or use another name. Pilothouse itself reads the file.",
    ),
    FindingCode(
        "ORDER_CONFLICT",
        ERROR,
        "`after` together with `order` or `sequence`, or `sequence` without `order: sequential`.",
        "Write one of them.",
    ),
    FindingCode(
        "ORDER_OF_A_NODE",
        ERROR,
        "`order`, `sequence` or `after` in the settings of a node, which has no parts.",
        "Move it to the system.",
    ),
    FindingCode(
        "SEQUENCE_INCOMPLETE",
        WARNING,
        "`sequence` does not name all parts of the system. The others begin at once.",
        "Name them all.",
    ),
    FindingCode(
        "DAG_CYCLE",
        ERROR,
        "Parts wait for each other in `after`, so that none of them could ever begin.",
        "Remove one of the dependencies.",
    ),
    FindingCode(
        "FALLBACK_CIRCLE",
        ERROR,
        "A mode falls back to itself, directly or through others.",
        "Let fallbacks lead in one direction.",
    ),
    FindingCode(
        "INVARIANT_CIRCLE",
        ERROR,
        "An invariant names an `INVARIANT_BROKEN` that rests on this very invariant, directly or "
        "through others: it would never come to rest, or never hold again.",
        "Name what lies behind the other invariant instead.",
    ),
    FindingCode(
        "UNREACHABLE_MODE",
        WARNING,
        "No plan reaches the mode: through several systems it requires different states of one "
        "part, it requires a mode that no plan reaches, or its guards name modes that cannot "
        "be entered before it.",
        "Correct the modes or guards; the message says which.",
    ),
    FindingCode(
        "FALLBACK_NEEDS_THE_SAME",
        WARNING,
        "The invariants of a fallback cannot hold either while an invariant of the mode is "
        "broken, or it activates the node that must be reachable.",
        "Choose another fallback, or weaken its invariants; `true` needs nothing.",
    ),
)

ERRORS = (
    FindingCode(
        "INVALID_ERROR_NAME",
        ERROR,
        "The name of an error has other characters than capital letters, digits and "
        "underscores, or more than 64, or does not begin with a letter.",
        "Use another name, such as `SCAN_LATE`.",
    ),
    FindingCode(
        "NAME_TAKEN",
        ERROR,
        "The name of an error is that of the emergency stop.",
        "Use another name.",
    ),
    FindingCode(
        "BUILT_IN_ERROR",
        ERROR,
        "The settings of an error that parts have anyway, such as `UNREACHABLE`, say how it is "
        "found or how it follows.",
        "Leave the key out, or declare an error of another name.",
    ),
    FindingCode(
        "ERROR_CIRCLE",
        ERROR,
        "An error depends on itself through `caused_by` or the conditions of errors; or a "
        "`critical` or `fatal` one rests on the state of the robot, its task or the hold `error`, "
        "which follow from it.",
        "Remove one of the dependencies; the message names them.",
    ),
    FindingCode(
        "NO_EFFECT",
        WARNING,
        "A key of an error has no effect beside the others: times without the condition that they "
        "are for, or how an error follows that is found by its own condition.",
        "Leave it out; the message says why.",
    ),
)

REACTIONS = (
    FindingCode(
        "INCOMPLETE_REACTION",
        ERROR,
        "A reaction lacks `when`, `action`, the `target` of a mode or a state, or one of "
        "`escalate_after_s` and `escalate_to`.",
        "Add it.",
    ),
    FindingCode(
        "INVALID_REACTION",
        ERROR,
        "The action cannot have this target, or has none; it cannot be done to this part, such as "
        "the restart of a system; or it has a budget and may act at any time.",
        "See the message.",
    ),
    FindingCode(
        "DUPLICATE_REACTION",
        ERROR,
        "Two parts have a reaction of the same name.",
        "Rename one: names are unique in a model.",
    ),
    FindingCode(
        "UNKNOWN_REACTION",
        ERROR,
        "`escalate_to` names no reaction.",
        "Correct the name.",
    ),
    FindingCode(
        "REACTION_CIRCLE",
        ERROR,
        "A reaction escalates to itself, directly or through others.",
        "Let escalations lead in one direction.",
    ),
    FindingCode(
        "REACTION_RESTS_ON_ITSELF",
        ERROR,
        "What the reaction does changes what its condition looks at: its part's state, mode, "
        "parameters or `converged`, its hold, `robot.state` or `task.status`. It would end as soon "
        "as it acts, and begin again.",
        "Name the cause itself, such as an error, or write `until: acknowledged`.",
    ),
)

CONDITIONS = (
    FindingCode(
        "CONDITION_SYNTAX",
        ERROR,
        "A condition cannot be read, or has more than 500 characters.",
        "See the message; split a long one, since all of a list must hold.",
    ),
    FindingCode(
        "UNKNOWN_SIGNAL",
        EITHER,
        "A condition, or `ros2.signals` of a robot file, names a signal that does not exist. "
        "For conditions a warning while no robot file is given, which may declare it.",
        "Correct the name, or declare it under `signals` of the robot file.",
    ),
    FindingCode(
        "UNKNOWN_ERROR",
        EITHER,
        "A condition names an error that nothing raises. A warning while no robot file is "
        "given, which may declare it.",
        "Correct the name.",
    ),
    FindingCode(
        "UNKNOWN_PARAMETER",
        EITHER,
        "A condition names a parameter of a system. As a warning: one that no mode of the node "
        "sets, so that it is unknown until the node reports it.",
        "Correct the name, or name a node.",
    ),
    FindingCode(
        "UNKNOWN_WORD",
        ERROR,
        "A fact is compared with a word that it can never be.",
        "Correct the word; the message lists those that it can be.",
    ),
    FindingCode(
        "WRONG_TYPE",
        ERROR,
        "A fact is compared with a value of another type, words by size, or a number or a word "
        "stands alone.",
        "Compare numbers with numbers, words with words; write what the fact is compared with.",
    ),
    FindingCode(
        "EMPTY_LIST",
        ERROR,
        "A fact is compared with an empty list.",
        "List the values.",
    ),
    FindingCode(
        "NEVER_KNOWN",
        WARNING,
        "A state is compared with `unknown`: while it is unknown, so is the comparison.",
        "Name a state, or use `reachable`.",
    ),
    FindingCode(
        "ALWAYS_TRUE",
        WARNING,
        "A comparison is true for every value that the signal can have.",
        "Leave it out, or correct the limit.",
    ),
    FindingCode(
        "NEVER_TRUE",
        WARNING,
        "A comparison is true for no value that the signal can have.",
        "Correct the limit.",
    ),
    FindingCode(
        "GUARD_NEVER_HOLDS",
        WARNING,
        "A condition of `requires` or `invariants` contradicts itself, another one of the same "
        "mode, or what the mode itself requires of its parts.",
        "Correct one of them; the message names the other.",
    ),
    FindingCode(
        "RESERVED_WORD",
        WARNING,
        "A part is named `error`, `robot`, `task`, `vehicle`, `hold`, `part` or `signal`, "
        "which have another meaning in conditions.",
        "Use another name, or write `part('task')` in conditions.",
    ),
)
