"""Machine types: each turns its parameters into a MachineDescription."""
