"""A carrier with one node and two reactions: one changes its mode, one holds the robot."""

CARRIER = """\
carrier:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {drive: active}
      SLOW: {drive: active.SLOW}
    reactions:
      LIMP: {when: "temperature > 40", action: mode, target: active.SLOW}
      HALT: {when: "battery_level < 0.3", action: hold, until: acknowledged}
drive:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.9}}
      SLOW: {ros__parameters: {speed: 0.1}}
"""
