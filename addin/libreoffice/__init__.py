"""The worksheet functions in LibreOffice Calc: an extension (.oxt) and the process behind it.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`component`     runs in LibreOffice's own Python: carries cells to the process and back
`names`         what the functions are called inside LibreOffice
`type_library`  the types of the component, in LibreOffice's binary form
`oxt`           the extension, made from the registry
`worker`        that process, in the Python where torsionbook is installed
==============  ==================================================================================

LibreOffice brings its own Python, without numpy; so `component` imports nothing of ours, and is
copied into the extension as it is.
"""
