from api.http.schemas.path_preview import PathPreviewJson
from domain.paths.preview import preview
from tests.support.approach_limits import approach_limits
from tests.support.paths import straight


def test_a_straight_path_of_an_unknown_vehicle_has_neither_radius_nor_start() -> None:
    view = preview(straight(), 2.8, None, approach_limits())
    shown = PathPreviewJson.of(view, [[0.0, 0.0], [20.0, 0.0]])

    assert (shown.min_radius_m, shown.start, shown.steerable) == (None, None, True)
    assert (shown.spacing.min_m, shown.spacing.max_m) == (1.0, 1.0)
    assert [(point.x_m, point.y_m) for point in shown.items] == [(0.0, 0.0), (20.0, 0.0)]
