"""The live bench: a machine in the browser that is solved again while its dimensions change.

============ ==========================================================================
module       responsibility
============ ==========================================================================
server       what the page asks for, as routes; start and end of the web server
guard        who is let in, and how much may be sent
workspace    what is kept on disk: designs, variants, runs, uploaded files
queue        runs that wait for their turn
workers      processes that compute and can be ended at once
computations what these processes are asked for
answers      a machine solved again from its last cyclic state
drawing      section, openings and rules of a machine as the browser draws them
handles      numbers that a designer takes hold of, and where they lie
static       the page: HTML, style, scripts, and uPlot (MIT) for its curves
============ ==========================================================================
"""
