"""Slaves as a system: what feeds what, in which unit and frame, what plays which role, what should be known before."""
