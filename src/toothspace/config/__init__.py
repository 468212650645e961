"""TOML case files to frozen cases: units, keys, messages."""
