"""What stands around the car while it parks: map, guard, and what they say."""
