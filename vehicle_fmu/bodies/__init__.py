"""The bodies: what moves the car, from a point on a circle to four wheels on tyres."""
