"""The calculation server: the worksheet functions and the recalculation over HTTP.

=================  ================================================================================
module             responsibility
=================  ================================================================================
`answers`          answers and refusals as JSON
`client`           A client of the calculation server, with the standard library alone
`office`           metadata, script and manifest for the Office host
`openapi`          the description of all this for programs
`settings`         addresses, keys, certificates and limits, fixed when the server starts
`dev_certificate`  a certificate for this machine alone
`listening`        the sockets of a server
`leaving`          how far a server is with leaving
`logs`             the log: lines of text or of JSON
`metrics`          what a server counts, for Prometheus
`configuration`    settings from flags, environment and file
`shared`           models and results that several servers share, in Redis or Valkey
`bodies`           bodies of requests: read within limits of size and time, as long as the client
                   is there
`keys`             API keys: which one a request carries, whether it is one of ours, who guesses
`policies`         what a browser may load for a page of this server
`protocol`         HTTP of a connection: time for headers, who may connect
`requests`         the guard in front of every route: names, origins, keys, and how much at a time
`studies`          a study of a case that is sent as JSON
`view`             what the page draws of a model
`bounded_reading`  reading an upload with bounds on size and memory
`file_tasks`       what the page does with a file beside its results: the task, inputs and edits
`documents`        verify, compare, study
`reports`          the report
`tasks`            what the processes do: starts, workbooks, tables, studies
`processes`        long calculations in a pool of processes: a bounded queue, and what is said of
                   its ends
`running_starts`   one calculation of a start for everybody who waits for it
`calls`            a list of function calls → their answers in the same order
`stream`           long calls over a WebSocket: stages, results as they come, cancel
`uploads`          a workbook in, the same workbook recalculated out; or what to write into it; or a
                   model of it
`document_routes`  the same over HTTP
`app`              routes, put together for one set of settings
`serving`          serving until the process is told to end, and ending without losing a call
=================  ================================================================================

Short functions run in threads of the server, long ones in a pool of processes, so that no start
keeps a cell waiting. Values are plain JSON; a double goes out with all its digits and comes back
as the same double. Nothing a client sends stays on disk.
"""
