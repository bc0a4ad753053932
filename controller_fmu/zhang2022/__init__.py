"""Quintic path, model predictive steering, PID speed (Zhang 2022)."""
