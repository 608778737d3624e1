"""The login page of a server that has a token."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Request, Response
from starlette.responses import HTMLResponse

from server.errors import Problem
from server.routes.body import parsed_body
from server.routes.schemas import Login
from server.security import COOKIE, Access

__all__ = ["router"]

router = APIRouter(prefix="/login", include_in_schema=False)

_PAGE = """<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>Trainbridge: log in</title>
    <link rel="stylesheet" href="/login/login.css">
    <script type="module" src="/login/login.js"></script>
  </head>
  <body>
    <main>
      <h1>Trainbridge</h1>
      <form id="login">
        <label for="token">Token</label>
        <input id="token" type="password" autocomplete="current-password" required autofocus>
        <button>Log in</button>
        <p id="message" role="alert"></p>
      </form>
      <p>The token is what the server was started with, in TRAINBRIDGE_TOKEN or --token-file.</p>
    </main>
  </body>
</html>
"""
_SCRIPT = """const form = document.getElementById("login");
form.addEventListener("submit", async (event) => {
  event.preventDefault();
  const token = document.getElementById("token").value;
  const answer = await fetch("/login", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ token }),
  });
  if (answer.ok) location.replace("/");
  else document.getElementById("message").textContent = (await answer.json()).detail;
});
"""
_STYLE = """body { font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 24rem; margin: 15vh auto; padding: 0 1rem; }
label, input, button { display: block; width: 100%; box-sizing: border-box; }
input, button { font: inherit; margin: 0.5rem 0; padding: 0.5rem; }
"""


@router.get("")
def read_login() -> HTMLResponse:
    """The page."""
    return HTMLResponse(_PAGE)


@router.get("/login.js")
def read_script() -> Response:
    """Its script."""
    return Response(_SCRIPT, media_type="text/javascript")


@router.get("/login.css")
def read_style() -> Response:
    """Its style."""
    return Response(_STYLE, media_type="text/css")


@router.post("", status_code=204, dependencies=[Depends(parsed_body)])
def log_in(login: Login, request: Request, response: Response) -> None:
    """Sets the cookie that proves the token."""
    access: Access = request.app.state.access
    if not access.token:
        raise Problem(404, "No token", "This server has no token: nobody needs to log in.")
    if not access.token_matches(login.token):
        raise Problem(401, "Wrong token", "That is not this server's token.")
    response.set_cookie(
        COOKIE,
        access.cookie_value(),
        max_age=30 * 24 * 3600,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
