"""What the server's stream says about one request."""

import json

from websockets.sync.client import connect

#: The last message about a request has one of these.
ENDS = {"value", "error", "cancelled"}


def stream_of(address):
    return connect(address.replace("http", "ws") + "/api/v1/stream", max_size=None)


def until_the_end(line, identity):
    """Everything said about one request, in order, the last thing last."""
    found = []
    while True:
        message = json.loads(line.recv(timeout=120))
        if message.pop("id") == identity:
            found.append(message)
            if ENDS & set(message):
                return found


def until_stage(line, stage):
    """Wait until a stage is named with these words; a request that ends before fails the test."""
    while stage not in (message := json.loads(line.recv(timeout=120))).get("stage", ""):
        assert not ENDS & set(message), message
