"""A small HTTP server in a thread, for protocols that are documented and whose servers are not at hand."""

import base64
import json
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qsl, urlsplit


class Answers:
    """Answers requests; says 503 to the first ones where `busy` is set."""

    login = None
    busy = 0

    def __init__(self):
        self.requests = []

    def answer(self, method, path, query, body):
        """Return status and JSON."""
        raise NotImplementedError


@contextmanager
def served(answers):
    """Serve on a port of the loopback; give it."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self):
            self._do(None)

        def do_POST(self):
            self._do(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))

        def _do(self, body):
            parts = urlsplit(self.path)
            answers.requests.append(parts.path)
            expected = None
            if answers.login is not None:
                expected = "Basic " + base64.b64encode(":".join(answers.login).encode()).decode()
            if expected is not None and self.headers.get("Authorization") != expected:
                status, content = 401, {"Message": "denied"}
            elif answers.busy > 0:
                answers.busy -= 1
                status, content = 503, {"Message": "busy"}
            else:
                status, content = answers.answer(self.command, parts.path, parse_qsl(parts.query), body)
            data = json.dumps(content).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
