"""Every tutorial runs to its end, and its notebook and its page are made of the script and of what it printed."""

import json
import os
import re
import runpy
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread

import pytest

from docs.render_tutorials import TUTORIALS, names, notebook, page, recorded, run, script_of
from overcooked_bench.cli import _parser

INDEX = (TUTORIALS / "index.md").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_a_tutorial_runs(name, tmp_path):
    before = set(TUTORIALS.iterdir())
    cells = run(script_of(name), tmp_path, short=True)
    assert [bool(text) for text in cells] == [bool(text) for text in recorded(name)]
    assert set(TUTORIALS.iterdir()) == before


@pytest.mark.parametrize("name", names())
def test_notebook_and_page_are_those_of_the_script(name):
    made = notebook(script_of(name), recorded(name))
    assert made == (TUTORIALS / f"{name}.ipynb").read_text("utf-8")
    assert page(made, name) == (TUTORIALS / f"{name}.md").read_text("utf-8")


@pytest.mark.parametrize("name", names())
def test_every_command_in_a_tutorial_can_be_parsed(name):
    text = (TUTORIALS / f"{name}.md").read_text("utf-8")
    for command in re.findall(r"`overcooked-bench ([^`]*)`", text):
        options = _parser().parse_args(command.split())
        assert callable(options.command)


@pytest.mark.parametrize("name", names())
def test_the_index_and_links_lead_to_tutorials(name):
    assert f"]({name}.md)" in INDEX
    text = (TUTORIALS / f"{name}.md").read_text("utf-8")
    for link in re.findall(r"\]\(([^)#:]+)\)", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        assert (TUTORIALS / link).exists(), link


@pytest.mark.parametrize("name", names())
def test_short_settings_are_settings_and_stay_out_of_pages(name):
    assert "# short: " in script_of(name)
    for line in script_of(name).splitlines():
        assert ("# short: " in line) == bool(re.fullmatch(r"[\w, ]+ = .*  # short: .+", line)), line
    assert "short: " not in (TUTORIALS / f"{name}.md").read_text("utf-8")


def test_the_chat_client_of_the_language_model_talks_to_a_server(tmp_path, monkeypatch):
    asked = []

    class Server(BaseHTTPRequestHandler):
        def do_POST(self):
            asked.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            body = json.dumps({"choices": [{"message": {"content": "dish, please"}}]}).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_):
            pass

    (source,) = re.findall(r"AGENT = '''\n(.*?)\n'''", script_of("language_model"), re.DOTALL)
    (tmp_path / "agent.py").write_text(source.replace("\\\\n", "\\n"))
    monkeypatch.chdir(tmp_path)
    with HTTPServer(("127.0.0.1", 0), Server) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        monkeypatch.setitem(os.environ, "CHAT_URL", f"http://127.0.0.1:{server.server_port}/v1/chat/completions")
        monkeypatch.setitem(os.environ, "CHAT_MODEL", "small")
        agent = runpy.run_path("agent.py")
        assert [agent["ask"]("which goal?") for _ in range(2)] == ["dish, please"] * 2
        server.shutdown()
    assert asked == [{"model": "small", "temperature": 0, "messages": [{"role": "user", "content": "which goal?"}]}]
