"""What a learned policy drives through: its observation, its actions, and when the car counts as parked."""
