"""Step tests: one model alone, inputs as steps, ramps, pulses, tables; its outputs held against expectations."""
