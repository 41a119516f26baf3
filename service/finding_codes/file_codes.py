"""Codes of robot files and waypoint files."""

from service.finding_codes.finding_code import EITHER, ERROR, WARNING, FindingCode

ROBOT_FILES = (
    FindingCode(
        "UNKNOWN_NODE",
        ERROR,
        "`nodes` names a node that is not in the model.",
        "Correct the name.",
    ),
    FindingCode(
        "DUPLICATE_ERROR",
        ERROR,
        "A signal of the robot file gives a part an error of a name that the part has already: a "
        "built-in one, or one of the model file.",
        "Use another name.",
    ),
    FindingCode(
        "MONITOR_CYCLE",
        ERROR,
        "A monitor is computed from itself, directly or through others.",
        "Let each chain of monitors begin at a signal that is read.",
    ),
    FindingCode(
        "NOT_CHAINABLE",
        ERROR,
        "A monitor is computed from an `age`, a `gap` or a `stuck_for`: these grow in silence, and "
        "a monitor takes one value per reading.",
        "Compute it from the signal itself.",
    ),
    FindingCode(
        "WINDOW_TOO_LARGE",
        ERROR,
        "With the period of its source, the window of a monitor holds more than 100,000 readings "
        "(20,000 for `percentile`). Windows of posted readings that do are unknown at run time.",
        "Shorten the window, or read the source less often.",
    ),
    FindingCode(
        "DEVICE_NAME",
        ERROR,
        "A device is named `supervisor`, which is the name of the computer that supervises the "
        "devices, or like a part.",
        "Give it another name.",
    ),
    FindingCode(
        "OWNED_TWICE",
        ERROR,
        "Two devices own a node, maybe through systems, or read a signal. Every node has one "
        "owner, who alone commands it.",
        "Name it in one of them; the message names the other.",
    ),
    FindingCode(
        "NOT_OWN",
        ERROR,
        "A device is to command a part on its own that is not all its own, or a mode with guards "
        "that it cannot judge alone.",
        "Name its own parts. What the guards of the mode rest on must be its own, too.",
    ),
    FindingCode(
        "OFFLINE_TOO_SOON",
        ERROR,
        "A device would act on its own before its supervisor counts as lost.",
        "Let `after_s` be at least `lost_s` of `link`.",
    ),
    FindingCode(
        "VEHICLE_ELSEWHERE",
        ERROR,
        "A device is to have the vehicle or its tasks. These are the supervisor's.",
        "Run the supervisor on the computer that drives.",
    ),
)

WAYPOINT_FILES = (
    FindingCode(
        "EMPTY_FILE",
        ERROR,
        "The file has no lines, or only comments.",
        "Send a recording.",
    ),
    FindingCode(
        "NOT_TEXT",
        ERROR,
        "The file contains null characters.",
        "Save it as CSV in UTF-8.",
    ),
    FindingCode(
        "NO_NUMBERS",
        ERROR,
        "There are lines of text and none of numbers.",
        "Send the rows, too.",
    ),
    FindingCode(
        "EMPTY_LINE",
        ERROR,
        "A line between waypoints is empty.",
        "Remove it.",
    ),
    FindingCode(
        "HEADER",
        ERROR,
        "A line of text before the numbers does not name as many columns as the first row has, "
        "or none of them is x or y.",
        "Name the columns: `?columns=x,y,yaw`.",
    ),
    FindingCode(
        "UNKNOWN_COLUMNS",
        ERROR,
        "No column is named x, or none y.",
        "Name the columns: `?columns=x,y,yaw`.",
    ),
    FindingCode(
        "AMBIGUOUS_COLUMNS",
        ERROR,
        "Several columns could be x, or y, such as `left_x` and `right_x`.",
        "Name the columns: `?columns=_,_,x,y`.",
    ),
    FindingCode(
        "LATITUDE_LONGITUDE",
        ERROR,
        "The columns are latitude and longitude.",
        "Project them, such as to UTM.",
    ),
    FindingCode(
        "WRONG_UNIT",
        ERROR,
        "x or y is not in m, such as `x_km`.",
        "Convert it.",
    ),
    FindingCode(
        "TOO_FEW_COLUMNS",
        ERROR,
        "A line has fewer columns than the first one, or there is only one.",
        "Add the missing values.",
    ),
    FindingCode(
        "TOO_MANY_COLUMNS",
        ERROR,
        "A line has more columns than the first one, or more than 1,000.",
        "Remove them.",
    ),
    FindingCode(
        "NOT_A_NUMBER",
        ERROR,
        "A cell that is read is empty or not a number.",
        "Write a number.",
    ),
    FindingCode(
        "DECIMAL_MARKS",
        ERROR,
        "The file has decimal commas and decimal points.",
        "Write decimal points.",
    ),
    FindingCode(
        "NOT_FINITE",
        ERROR,
        "`nan`, `inf`, or a number that overflows.",
        "Remove the line.",
    ),
    FindingCode(
        "TOO_FAR",
        ERROR,
        "x or y is further than 10,000 km from the origin.",
        "Use m.",
    ),
    FindingCode(
        "NO_ROTATION",
        ERROR,
        "A quaternion is 0.",
        "Leave the quaternions out: `?columns=x,y`.",
    ),
    FindingCode(
        "TOO_FEW_POINTS",
        ERROR,
        "One waypoint; a path needs at least 2.",
        "Record a longer path.",
    ),
    FindingCode(
        "TOO_MANY_POINTS",
        ERROR,
        "More than 100,000 waypoints, or 200,000 lines.",
        "Leave points out; one every 0.1 m is enough.",
    ),
    FindingCode(
        "NOT_A_PATH",
        ERROR,
        "Without names, the first two columns are taken as x and y, and are not: they begin "
        "with a time, a count of rows or the distance along the path, or are latitude and "
        "longitude, or pose matrices.",
        "Name the columns: `?columns=s,x,y`.",
    ),
    FindingCode(
        "HEADINGS_MISFIT",
        EITHER,
        "Headings differ from the direction of the path by more than 30 degrees in any unit "
        "(median). The third column of a file without names may be something else, such as a "
        "width or a speed.",
        "Leave the column out: `?columns=x,y`. Or say that it is a heading, and its unit: "
        "`?heading=deg`.",
    ),
    FindingCode(
        "HEADINGS_REVERSED",
        WARNING,
        "Headings point backwards along the path: the recording vehicle reversed. The path is "
        "driven forwards.",
        "None is needed.",
    ),
    FindingCode(
        "HEADINGS_ZERO",
        WARNING,
        "All headings are 0, and do not fit the path. They are not used.",
        "None is needed.",
    ),
)

ALL_FILES = (
    FindingCode(
        "MORE_FINDINGS",
        EITHER,
        "There are more than 1,000 findings; this one counts the rest.",
        "Mend those that are listed.",
    ),
)
