"""What every model package is made of: signals, a model descriptor and plain maths.

``signal``, ``maths`` and ``random`` may be imported by model code; ``variables`` and
``model`` read the types of a model package and are for the rooms around it.
"""
