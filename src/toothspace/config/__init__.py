"""TOML case files to frozen cases: units, keys, messages.

============ ==========================================================
module       responsibility
============ ==========================================================
load         one case file to one :class:`toothspace.case.Case`
document     text of a file to tables, and tables to normalised text
overrides    ``key=value`` of the command line
reader       tables to dataclasses along their declared keys
allowed      what a key allows, in words
rules        what several keys must fulfil together
json_schema  JSON Schema of all keys
reference    reference page of all keys
============ ==========================================================
"""

from __future__ import annotations

from toothspace.config.load import case_from_text, load_case

__all__ = ["case_from_text", "load_case"]
