"""What several systems share: the slot's frame, the watch over car, driver and steering, the wheel's request."""
