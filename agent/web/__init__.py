"""The page and its REST interface: FastAPI routes, server-sent events, and the files that a browser loads."""
