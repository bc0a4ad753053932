"""A whole automated parking assist: slot search, planners, tracking, position tuning, supervision."""
