"""A form for cases in the browser, from the model of a case, served to this computer alone.

=========== ==========================================================
module      responsibility
=========== ==========================================================
server      what the browser asks for, guarded: cases, their check, the one run
page.html   the form, built in the browser from the JSON Schema
=========== ==========================================================
"""
