"""The attack that stays: odd inputs, damaged logs, places, kills and FMI calls. ``make fuzz`` runs it for long."""
