"""How far tests have been through the state machines: states, transitions, and each guard true and false."""
