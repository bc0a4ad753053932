"""The ultrasonic sensor model: pose, field of view, predicted range, validity of a reading, silent sensors."""
