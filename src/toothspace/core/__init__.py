"""Types, constants, errors and registry that every layer may use.

=========== ==========================================================
module      responsibility
=========== ==========================================================
types       array aliases
errors      exceptions that a user sees as one line
status      outcome of a run, with advice, and what happened in it
units       quantities with units in text, converted to SI; physical constants
signals     columns of CSV files in SI units
files       files that are complete or not there, arrays kept between runs
netcdf      datasets as NetCDF files with a checksum
processes   processes that compute for another one
interrupts  signals that end the program, held while files are written
registry    machine types found by name (built in or entry points)
compiled    numba with a cache that follows the package's sources
=========== ==========================================================
"""
