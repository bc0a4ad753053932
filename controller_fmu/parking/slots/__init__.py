"""Slot candidates: gaps in a row of sides, with the likelier slot type, the goal pose, or the reason for rejection."""
