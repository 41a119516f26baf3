from domain.computers import ComputerName
from domain.devices.settings import (
    NOTHING_OFFLINE,
    DeviceSettings,
    LeadSettings,
    OfflineSettings,
    ownership_text,
)
from domain.lifecycle import LifecycleState
from domain.state_and_mode import ModeName, StateAndMode
from domain.timebase import seconds
from tests.support.models import ARM, BASE

INACTIVE = StateAndMode(LifecycleState.INACTIVE)
SLOW = StateAndMode(LifecycleState.ACTIVE, ModeName("SLOW"))
AT_REST = OfflineSettings(seconds(2), {BASE: INACTIVE}, reactions=True)


def text(*devices: DeviceSettings, lost_s: float = 1.5) -> str:
    return ownership_text(devices, seconds(0.5), seconds(lost_s))


def device(name: str = "base", offline: OfflineSettings = AT_REST) -> DeviceSettings:
    return DeviceSettings(ComputerName(name), (BASE,), ("motor_temperature",), offline)


def test_what_a_device_does_when_cut_off_is_said_in_words() -> None:
    assert AT_REST.words == "after 2 s: drive_base to inactive; its reactions act"
    assert NOTHING_OFFLINE.words == "after 2 s: nothing changes"


def test_a_device_waits_from_the_loss_until_it_acts() -> None:
    lead = LeadSettings(ComputerName("base"), AT_REST, lost=seconds(1.5))

    assert lead.waits == seconds(0.5)


def test_a_loss_noticed_late_leaves_nothing_to_wait_for() -> None:
    assert LeadSettings(ComputerName("base"), AT_REST, lost=seconds(3)).waits == 0


def test_devices_in_another_order_are_the_same_robot() -> None:
    base, arm = device(), DeviceSettings(ComputerName("arm"), (ARM,))

    assert text(base, arm) == text(arm, base)


def test_another_owner_is_another_robot() -> None:
    assert text(device("base")) != text(device("arm"))


def test_doing_something_else_when_cut_off_is_another_robot() -> None:
    others = (
        OfflineSettings(seconds(3), {BASE: INACTIVE}, reactions=True),
        OfflineSettings(seconds(2), {BASE: SLOW}, reactions=True),
        OfflineSettings(seconds(2), {BASE: INACTIVE}),
    )

    assert len({text(device(offline=offline)) for offline in (AT_REST, *others)}) == 4


def test_targets_in_another_order_are_another_robot() -> None:
    one = OfflineSettings(targets={BASE: INACTIVE, ARM: INACTIVE})
    other = OfflineSettings(targets={ARM: INACTIVE, BASE: INACTIVE})

    assert text(device(offline=one)) != text(device(offline=other))


def test_another_silence_after_which_computers_are_lost_is_another_robot() -> None:
    assert text(device()) != text(device(), lost_s=2)
