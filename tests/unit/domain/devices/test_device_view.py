import pytest

from domain.computers import ComputerName, DeviceState
from domain.devices.device_view import DeviceView
from domain.devices.settings import NOTHING_OFFLINE


@pytest.mark.parametrize("state", DeviceState)
def test_a_device_that_is_late_is_still_commanded(state: DeviceState) -> None:
    view = DeviceView(
        ComputerName("arm"), state, 0, "", (), NOTHING_OFFLINE, None, None, None, False, "", ()
    )

    assert view.is_connected is (state in (DeviceState.CONNECTED, DeviceState.LATE))
