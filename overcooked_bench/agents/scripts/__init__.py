"""Partners that follow a script: deterministic functions of the kitchen's state and the time."""
