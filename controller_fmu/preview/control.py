"""Front-wheel angle and drive force from the two fuzzy controllers."""

from controller_fmu.preview.fuzzy import infer
from controller_fmu.preview.params import PreviewParams, RuleTable
from controller_fmu.preview.preview import PreviewErrors
from controller_fmu.preview.rule_tables import FORCE, STEERING_PRINTED, STEERING_SYMMETRIC

UNIVERSE_LIMIT = 3.0


def steering_angle(sight: PreviewErrors, params: PreviewParams) -> float:
    """Return the front-wheel angle [rad], left positive, from yL and epsL (Table 1)."""
    y = params.lateral_gain * UNIVERSE_LIMIT * sight.y_l / params.lateral_range
    eps = params.heading_gain * UNIVERSE_LIMIT * sight.eps_l / params.heading_range
    rules = STEERING_PRINTED if params.rules == RuleTable.PRINTED else STEERING_SYMMETRIC
    out = infer(y, eps, params.lateral_peaks, params.heading_peaks, params.steering_peaks, rules)
    return params.steering_range * out / UNIVERSE_LIMIT


def drive_force(speed_error: float, rate: float, params: PreviewParams) -> float:
    """Return the drive (+) or brake (-) force [N] from v - v_set [m/s] and its rate [m/s^2] (Table 2)."""
    error = UNIVERSE_LIMIT * speed_error / params.speed_range
    change = UNIVERSE_LIMIT * rate / params.rate_range
    out = infer(error, change, params.speed_peaks, params.rate_peaks, params.force_peaks, FORCE)
    return params.force_range * out / UNIVERSE_LIMIT
