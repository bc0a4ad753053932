"""What the side sensors tell while the driver drives past: edges, lines, corners, slots."""
