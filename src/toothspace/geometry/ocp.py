"""Output of the library that reads and writes STEP files."""

from __future__ import annotations


def silence_ocp() -> None:
    """Keep the STEP library from writing progress and complaints to standard output."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)
