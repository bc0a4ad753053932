"""Public benchmark scenes of parking: read, planned, driven, and compared in one table."""
