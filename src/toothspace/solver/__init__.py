"""March in time, find the cyclic state, log events."""
