"""What stands around the car, and the still picture of a run."""
