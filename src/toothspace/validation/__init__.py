"""Published numbers, claims and figures, each with a computation that is laid over it.

===================== =====================================================
module                responsibility
===================== =====================================================
claim                 values, curves, tolerances and verdicts; reference data and cases
published_films       journal bearings and pads of the literature
lateral               floating bearing of the fuel pump
motor_startup         start-up of the gear motor
gerotor               torque and contacts of the gerotor
reference_machines    reference machines within catalogue and published ranges, and pumps of
                      makers' service manuals, held one-sided
book                  all claims, and running them
===================== =====================================================
"""
