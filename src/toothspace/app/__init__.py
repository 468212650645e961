"""A form for cases in the browser, from the model of a case, served to this computer alone.

=========== ==========================================================
module      responsibility
=========== ==========================================================
session     cases that can be opened, their check, the one run
server      what the browser asks for, guarded
page.html   the form, built in the browser from the JSON Schema
=========== ==========================================================
"""
