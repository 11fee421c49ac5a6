"""The calculation server: the worksheet functions and the recalculation over HTTP.

| module | responsibility |
|---|---|
| `settings` | addresses, keys, certificates and limits, fixed when the server starts |
| `work` | long calculations in processes of their own: queue, progress, time limit, cancel |
| `starts` | one calculation of a start for everybody who waits for it |
| `studies` | a study of a case that is sent as JSON |
| `calls` | a list of function calls → their answers in the same order |
| `stream` | long calls over a WebSocket: stages, results as they come, cancel |
| `uploads` | a workbook in, the same workbook recalculated out; or a model of it |
| `view` | what the page draws of a model |
| `office` | metadata, script and manifest for the Office host |
| `guard` | keys, limits and errors of every request |
| `openapi` | the description of all this for programs |
| `app` | routes, put together for one set of settings |
| `commands` | `torsionbook serve` |

Short functions run in threads of the server, long ones in a pool of processes, so that no start
keeps a cell waiting. Values are plain JSON; a double goes out with all its digits and comes back
as the same double. Nothing a client sends stays on disk.
"""
