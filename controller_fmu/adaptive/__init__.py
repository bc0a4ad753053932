"""Driver-adaptive parking: clothoid paths sized by the driver's speed, predicted stops, planned anew when standing."""
