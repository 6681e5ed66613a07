"""The documentation as a site: ``python -m docs.site``, or ``make site``.

Pages are those of ``docs``; a gallery of laws and effects, the figures of the paper, the executed
walkthroughs and the reference of the API are made from the package at each build, so that nothing
on them can be older than the code.
"""
