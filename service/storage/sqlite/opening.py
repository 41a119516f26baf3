"""Opens a folder for a run, and says what an earlier run left."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from pydantic_core import from_json

from domain.actor import SERVICE
from domain.errors import PilothouseError
from domain.inputs import Restored
from domain.kept import Kept, KeptEmergencyStop
from service.clock import since_epoch, to_datetime
from service.codec.codec import KEPT
from service.codec.names import NAMES
from service.storage.errors import UnusableFolderError
from service.storage.id_blocks import BOOT, CHANGE, EVENT, TASK, IdBlocks, IdKind, unreserved
from service.storage.journal import ANNOUNCED, Boot, Found, Plain
from service.storage.sqlite.announced_file import AnnouncedFile
from service.storage.sqlite.batch import IDS, OWN, Changes
from service.storage.sqlite.connection import FAILURES, words
from service.storage.sqlite.folder import DEFAULT_RETENTION, Folder, Report, Retention, Start
from service.storage.sqlite.folder_lock import FolderLock
from service.storage.sqlite.log_file import Next, Run
from service.storage.sqlite.looking import Left, look, look_at_copy
from service.storage.sqlite.places import Places


@dataclass(frozen=True, slots=True)
class StoreSettings:
    """Where a robot's data are, and how much of them is kept."""

    folder: Path
    robot: str
    """Name of the robot that the folder belongs to."""
    retention: Retention = DEFAULT_RETENTION
    backlog_bytes: int = 16 * 2**20
    """How much may wait for a disk that is slow or fails."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A folder that a run goes on in."""

    lock: FolderLock
    folder: Folder
    announced: AnnouncedFile
    found: Found
    ids: IdBlocks
    next: Next
    report: Report
    fault: str | None = None
    """Why nothing can be written yet; None: the run has begun on disk."""


def open_folder(settings: StoreSettings, boot: Boot) -> Opened:
    """Take a folder, bring it up to the end of its log, and write down that a run begins.

    A disk that cannot be written is no obstacle: what is there is read, and the rest is up to
    `Folder.recover`.

    Args:
        settings: The folder, which is made if it is missing, and whose it is.
        boot: The run.

    Raises:
        UnusableFolderError: It is in use, of another robot, or cannot be used at all.
    """
    places = Places(settings.folder)
    try:
        places.make()
        lock = FolderLock(places.lock)
    except OSError as error:
        raise UnusableFolderError(f"{places.folder} cannot be used: {words(error)}") from error
    try:
        return _begin(settings, places, boot, lock)
    except BaseException:
        lock.release()
        raise


def _begin(settings: StoreSettings, places: Places, boot: Boot, lock: FolderLock) -> Opened:
    """Begin the run in a folder that this process has locked."""
    left, fault = _looked(places, settings.robot)
    ids = left.next_ids()
    if fault is None:
        opened = _prepared(settings, lock, left, boot, ids)
        try:
            opened.folder.start(left)
            opened.announced.renew()
        except FAILURES as error:
            fault = words(error)
            opened.folder.close()
        else:
            return replace(opened, report=opened.folder.report())
    opened = _prepared(settings, lock, left, boot, unreserved(ids, boot.wall_at))
    return replace(opened, fault=fault)


def _prepared(
    settings: StoreSettings, lock: FolderLock, left: Left, boot: Boot, ids: Mapping[IdKind, int]
) -> Opened:
    """Return a folder that nothing is written to yet."""
    blocks = IdBlocks(ids)
    found = _found(left, boot, ids)
    changes = _first_changes(found.restored, blocks, boot)
    run = Run(ids[BOOT], boot, since_epoch(boot.wall_at))
    start = Start(run, changes, left.next_numbers(ids[EVENT]))
    places = Places(settings.folder)
    folder = Folder(places, settings.robot, settings.retention, start)
    announced = AnnouncedFile(places.announced)
    return Opened(lock, folder, announced, found, blocks, start.next, folder.report())


def _looked(places: Places, robot: str) -> tuple[Left, str | None]:
    """Return what an earlier run left, and why nothing can be written there, if so."""
    try:
        return look(places, robot), None
    except FAILURES as error:
        fault = words(error)
    try:
        return look_at_copy(places, robot), fault
    except FAILURES as error:
        return Left(broken={places.folder: words(error)}), fault


def _found(left: Left, boot: Boot, ids: Mapping[IdKind, int]) -> Found:
    values, left_out = _read_back(left)
    stop_because = _stop_because(left)
    newest = left.newest
    return Found(
        Restored(values, ids[BOOT], ids[EVENT], ids[CHANGE], ids[TASK], stop_because, boot.epoch),
        left.is_new,
        to_datetime(newest.wall_ns) if newest and newest.wall_ns else None,
        {epoch: last for file in left.files for epoch, last in file.epochs.items() if last},
        _own(left),
        left_out,
    )


def _first_changes(first: Restored, blocks: IdBlocks, boot: Boot) -> Changes:
    """Return what is kept from the start on, before the run does anything."""
    changes: Changes = {}
    if first.stop_because:
        stop = KeptEmergencyStop(True, SERVICE.label, first.stop_because, boot.started_at)
        changes[NAMES[KeptEmergencyStop], stop.name] = KEPT.encode(stop)
    for kind, end in ({BOOT: first.boot + 1} | blocks.reserve()).items():
        changes[IDS, kind] = str(end).encode()
    return changes


def _stop_because(left: Left) -> str:
    """Return why the emergency stop is engaged; empty: it is as it was kept."""
    return "; ".join(f"{path.name} cannot be used: {why}" for path, why in left.broken.items())


def _read_back(left: Left) -> tuple[tuple[Kept, ...], tuple[str, ...]]:
    """Return values of the core; what cannot be read stays stored, and is told in words."""
    values, left_out = [], []
    for (kind, name), text in left.kept.items():
        if kind in (IDS, OWN):
            continue
        try:
            values.append(KEPT.decode(text))
        except PilothouseError as error:
            left_out.append(f"{kind} {name!r}: {error.message}")
    return tuple(values), tuple(left_out)


def _own(left: Left) -> dict[str, Plain]:
    own = {name: from_json(text) for (kind, name), text in left.kept.items() if kind == OWN}
    if left.announced is not None:
        own[ANNOUNCED] = from_json(left.announced)
    return own
