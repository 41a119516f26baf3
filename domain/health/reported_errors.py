"""Errors of parts that others find and report, such as a driver or the operator."""

from domain.concern import Concern, Takers
from domain.errors import NotReportedError, UnknownErrorNameError, UnknownPartError, shortened
from domain.events.health import ErrorReported
from domain.events.service import NotRestored
from domain.health.error_list import ErrorList, Found
from domain.inputs import ErrorReport, Restored
from domain.kept import KeptReport
from domain.outbox import Outbox
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, ErrorState
from domain.state_and_mode import PartName
from domain.timebase import Instant

MAX_MESSAGE = 500
"""Characters of a message."""


class ReportedErrors(Concern):
    """Raises an error as it is reported, until it is reported to be over; also over a restart."""

    def __init__(self, model: SmhModel, errors: ErrorList, outbox: Outbox) -> None:
        self._model = model
        self._errors = errors
        self._outbox = outbox

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {ErrorReport: self.take_report, Restored: self.take_restored}

    def take_report(self, report: ErrorReport, now: Instant) -> None:
        """Raise an error, or clear it.

        Raises:
            UnknownPartError: The part is not in the model.
            UnknownErrorNameError: The part has no such error.
            NotReportedError: It is found by other means.
        """
        part = self._check(report)
        key = ErrorKey(part, report.error)
        message = shortened(report.message, MAX_MESSAGE)
        told = ErrorReported(part, report.error, report.active, message, report.value)
        self._outbox.begin(now, told, report.actor)
        if not report.active:
            if self._errors.is_on(key):
                self._outbox.forget(KeptReport, key.name)
                self._errors.clear(key)
            return
        own = self._errors.causes.declared[key]
        found = Found(ErrorState.ACTIVE, message or own.message or "reported", report.value)
        before = self._errors.view(key)
        self._errors.raise_(key, found, now)
        after = self._errors.view(key)
        if after is before:
            # A driver may report it again and again.
            return
        since = now if after.since is None else after.since
        self._outbox.keep(KeptReport(part, key.error, found.message, report.value, since))

    def take_restored(self, restored: Restored, now: Instant) -> None:
        """Raise again what was reported before the restart."""
        for kept in restored.kept:
            if not isinstance(kept, KeptReport):
                continue
            key = ErrorKey(kept.part, kept.error)
            if not self._is_reported(key):
                self._outbox.forget(KeptReport, kept.name)
                why = f"nobody reports {key.name} any more"
                self._outbox.emit(NotRestored(f"the error {key.name}", why))
                continue
            found = Found(ErrorState.ACTIVE, kept.message, kept.value)
            self._errors.raise_(key, found, min(kept.since, now))

    def _is_reported(self, key: ErrorKey) -> bool:
        return self._errors.causes.is_reported(key) and not self._errors.is_of_signal(key)

    def _check(self, report: ErrorReport) -> PartName:
        """Return the part whose error is reported."""
        part, error = report.part, report.error
        if part is not None and part not in self._model:
            raise UnknownPartError("part", part, self._model.parts)
        if part is not None and self._is_reported(ErrorKey(part, error)):
            return part
        known = tuple(self._errors.names_of(part))
        if error in known:
            raise NotReportedError(ErrorKey(part, error).name)
        raise UnknownErrorNameError(f"error of {part or 'the robot itself'}", error, known)
