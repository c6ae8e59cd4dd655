"""The form that takes the token: plain HTML, no script, nothing else of the page."""

from __future__ import annotations

import html

FORM = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>slipjump: sign in</title>
</head>
<body>
<main>
<h1>slipjump</h1>
<p role="alert">{problem}</p>
<form method="post" action="/sign-in">
<p><label for="token">Token of this agent (agent.http.token in its configuration)</label></p>
<p><input id="token" name="token" type="password" autocomplete="current-password" required autofocus></p>
<p><button>Sign in</button></p>
</form>
</main>
</body>
</html>
"""


def sign_in_page(problem: str = "") -> str:
    """Return the form, with what was wrong the last time."""
    return FORM.format(problem=html.escape(problem))
