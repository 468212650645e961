"""Functional mock-up units: a machine for simulators of systems.

================ ==========================================================
module           responsibility
================ ==========================================================
operating_tables steady runs over pressure difference and shaft speed
archive          the files of a unit: description, sources, binary
export           from a case to a unit
machine_file     the whole machine as a file that the C library reads
machine_unit     the whole machine as a unit of FMI 2.0 or 3.0
machine.c        the machine in C, as it stands in the sources of every unit
================ ==========================================================
"""
