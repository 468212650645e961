"""The library of compiled code: what is built from the compiled functions of the package."""
