"""What an engineer should know of a machine and of a result, asked when somebody wants to know."""
