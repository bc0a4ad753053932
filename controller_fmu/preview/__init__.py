"""Dual-point preview with fuzzy steering and speed on sharp curves (the preview paper)."""
