"""Runs at the pace of the clock on the wall: how late they are, who looks on, what is changed meanwhile."""
