"""Published numbers, claims and figures, each with a computation that is laid over it.

===================== =====================================================
module                responsibility
===================== =====================================================
claim                 values, curves, tolerances and verdicts
resources             reference data and cases of an installation
published_films       journal bearings and pads of the literature
lateral               floating bearing of the fuel pump
motor_startup         start-up of the gear motor
gerotor               torque and contacts of the gerotor
service_manuals       pumps of makers' service manuals, held one-sided
reference_machines    reference machines within catalogue and published ranges
book                  all claims, and running them
===================== =====================================================
"""
