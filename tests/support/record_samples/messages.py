"""A value or two of each message that computers of one robot send each other."""

from collections.abc import Mapping

from domain.commands import AskFacts, AskTransition
from domain.computers import SUPERVISOR, ComputerName, Incarnation, Session, StopId
from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    NodeAnswer,
    NodeReport,
    ReactionReport,
    Reading,
    Readings,
    SourceFault,
)
from domain.lifecycle import LifecycleState, Transition
from domain.link.messages import (
    Beat,
    EngagedStop,
    Message,
    NodeOrder,
    Refused,
    Report,
    StopsPassedOn,
    Terms,
)
from domain.reaction_terms import ReactionState
from domain.state_and_mode import ModeName, PartName

_TERMS = Terms(model="1b" * 32, ownership="2c" * 32, protocol=1, version="0.9.1")

MESSAGES: Mapping[str, tuple[Message, ...]] = {
    "beat": (
        Beat(
            sender=ComputerName("arm"),
            incarnation=Incarnation("0f" * 16),
            seq=41,
            terms=_TERMS,
            heard=Incarnation("a5" * 16),
            heard_seq=40,
            session=Session("c3" * 16),
            renew=Session("d2" * 16),
            autonomous=True,
            stops=(
                EngagedStop(
                    id=StopId("arm-0f0f-3"),
                    by="ada",
                    reason='Größe ≤ 3 — "gripper\\jam"',
                    age=1_500_000_000,
                ),
            ),
            stops_version=3,
            heard_stops=2,
            releases=(StopId("supervisor-a5a5-3"),),
            refused=(
                Refused(
                    incarnation=Incarnation("b4" * 16),
                    code="SECOND_SUPERVISOR",
                    message="another supervisor is dealt with",
                ),
            ),
            passed_on=(
                StopsPassedOn(
                    computer=ComputerName("base"),
                    incarnation=Incarnation("e1" * 16),
                    version=2,
                    stops=(EngagedStop(id=StopId("base-e1e1-3"), by="ben", reason="", age=0),),
                    is_dealt_with=True,
                ),
            ),
        ),
        Beat(
            sender=SUPERVISOR,
            incarnation=Incarnation("a5" * 16),
            seq=1,
            terms=_TERMS,
            heard=None,
            heard_seq=0,
            session=None,
            renew=None,
            autonomous=False,
            stops=(),
            stops_version=0,
            heard_stops=0,
            releases=(),
            refused=(),
        ),
    ),
    "report": (
        Report(
            sender=ComputerName("arm"),
            incarnation=Incarnation("0f" * 16),
            seq=7,
            items=(
                NodeReport(
                    node=PartName("left/arm"),
                    state=LifecycleState.INACTIVE,
                    mode=ModeName("FAST"),
                    reachable=True,
                ),
                NodeAnswer(request=41, node=PartName("left/arm"), accepted=False, reason="busy"),
                Readings(items=(Reading(signal="motor_temperature", value=41.5),), source="can"),
                SourceFault(signal="disk", source="os disk /", reason="No such file"),
                ErrorReport(part=PartName("left/arm"), error="JAMMED", active=True),
                CheckpointReport(node=PartName("left/arm"), checkpoint="cycle"),
                ReactionReport(
                    part=PartName("left/arm"), reaction="LIMP", state=ReactionState.ACTING
                ),
            ),
            complete=True,
            session=Session("c3" * 16),
        ),
        Report(
            sender=ComputerName("arm"),
            incarnation=Incarnation("0f" * 16),
            seq=8,
            items=(),
            complete=False,
            session=None,
        ),
    ),
    "node_order": (
        NodeOrder(
            sender=SUPERVISOR,
            incarnation=Incarnation("a5" * 16),
            seq=9,
            session=Session("c3" * 16),
            command=AskTransition(
                request=41, node=PartName("left/arm"), transition=Transition.ACTIVATE
            ),
            heard_seq=40,
        ),
        NodeOrder(
            sender=SUPERVISOR,
            incarnation=Incarnation("a5" * 16),
            seq=10,
            session=Session("c3" * 16),
            command=AskFacts(request=42, node=PartName("left/arm")),
            heard_seq=0,
        ),
    ),
}
