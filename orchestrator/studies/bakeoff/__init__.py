"""Every parking controller on the same slots, cars, bodies and disturbances."""
