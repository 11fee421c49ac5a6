"""The MCP server: workbooks read, calculated and explained for an assistant that speaks this protocol.

=========  =======================================================================
module     responsibility
=========  =======================================================================
`places`   which files may be read, and where one may be written
`tasks`    what the processes do beyond the tasks of the server
`front`    the tools, over standard input and output
=========  =======================================================================

Numbers are those of the command line: the same reading, calculation and worksheet functions.
"""
