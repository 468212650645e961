"""Compiled code: what is compiled, the library that holds it, and Numba where that compiles."""
