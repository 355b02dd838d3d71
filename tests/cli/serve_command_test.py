# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina serve`: messages by standard input and by a socket, wrong ones, and sides that die.
serve_command_test.py LAMINA"""

import base64
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

lamina = str(Path(sys.argv[1]).resolve())
folder = Path(tempfile.mkdtemp())
os.chdir(folder)

SCENE = {
    "lamina": "scene", "version": 1, "mm_per_unit": 1,
    "camera": {"position": [0, 0, 9], "look_at": [0, 0, 0]}, "film": {"width": 24, "height": 16},
    "materials": {"wall": {"diffuse": 0.5}},
    "meshes": [{"shape": "sphere", "material": "wall"}],
    "lights": [{"type": "environment", "radiance": 1}], "render": {"samples_per_pixel": 2},
}
Path("scene.json").write_text(json.dumps(SCENE))


class Client:
    """A process, or a client of one, by lines."""

    def __init__(self, send, receive):
        self.send_bytes, self.receive, self.count = send, receive, 0

    def send(self, **message):
        self.count += 1
        self.send_bytes((json.dumps({"id": self.count, **message}) + "\n").encode())
        return self.count

    def line(self):
        line = self.receive()
        assert line, "no answer"
        return json.loads(line)

    def ask(self, **message):
        number = self.send(**message)
        while True:
            answer = self.line()
            if answer.get("id") == number:
                return answer

    def refused(self, text, **message):
        answer = self.ask(**message)
        assert text in answer.get("error", ""), (text, answer)


def start(*arguments):
    process = subprocess.Popen([lamina, "serve", "scene.json", *arguments], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    client = Client(lambda data: (process.stdin.write(data), process.stdin.flush()), process.stdout.readline)
    return process, client, client.line()


def fresh(*settings):
    """Colors of the picture that `lamina render` makes."""
    arguments = [argument for setting in settings for argument in ("--set", setting)]
    subprocess.run([lamina, "render", "scene.json", "-o", "wanted.png", *arguments], check=True, capture_output=True)
    return Path("wanted.png").read_bytes()


def check_messages():
    process, client, ready = start()
    assert ready["command"] == "serve", ready
    picture = client.ask(do="get", format="png", wait="final")
    # Samples are added without end: the first final picture has those of the scene.
    assert picture["picture"]["is_final"] and picture["picture"]["width"] == 24
    if picture["picture"]["samples_per_pixel"] == 2:
        assert base64.b64decode(picture["data"]) == fresh()
    change = client.ask(do="set", values={"materials.wall.diffuse": [0.9, 0.1, 0.1], "film.width": 20})["change"]
    assert change == 2
    picture = client.ask(do="get", format="raw", wait="any")
    assert picture["picture"]["change"] == 2
    colors = struct.unpack(f"<{20 * 16 * 3}f", base64.b64decode(picture["data"]))
    middle = colors[3 * (8 * 20 + 10) :][:3]
    assert middle[0] > 2 * middle[1] > 0, middle
    assert client.ask(do="camera", position=[0, 0, 12])["change"] == 3
    assert client.ask(do="region", region=[2, 3, 5, 6])["change"] == 4
    picture = client.ask(do="get", format="exr", wait="any")["picture"]
    assert (picture["width"], picture["height"], picture["region"]) == (5, 6, [2, 3, 5, 6])
    client.ask(do="region", region=None)
    assert client.ask(do="events", format="none")["events"] is True
    client.ask(do="set", values={"materials.wall.diffuse": 0.4})
    while client.line().get("event") != "picture":
        pass
    assert client.ask(do="events", format=None)["events"] is False
    assert client.ask(do="status")["change"] == 6

    # What is wrong is named, and all goes on.
    client.refused('message:1: do must be "set"', do="sett")
    client.refused('unknown key "value"', do="set", value={})
    client.refused('--set camera.position', do="set", values={"camera.position": 3})
    client.refused("there is no such file", do="set", values={"materials.wall.diffuse": {"map": "no.png", "encoding": "srgb"}})
    client.refused("region", do="region", region=[0, 0, 999, 1])
    client.refused("format must be \"png\"", do="get", format="gif")
    for text, why in ((b"{", "message:1"), (b"3", '"do"'), (b"\xff", "message"), (b"[" * 500, "message:1"),
                      (b'{"do": "status", "do": "quit"}', "message:1"), (b"x" * (3 << 20), "at most")):
        process.stdin.write(text + b"\n")
        process.stdin.flush()
        answer = client.line()
        assert answer["id"] is None and why in answer["error"] and "\n" not in answer["error"], (text[:20], answer)
    assert client.ask(do="status")["change"] == 6
    # A file that has changed.
    Path("scene.json").write_text(json.dumps({**SCENE, "film": {"width": 30, "height": 16}}))
    assert client.ask(do="reload")["change"] == 7
    client.ask(do="cancel")
    client.ask(do="quit")
    assert process.wait(20) == 0
    Path("scene.json").write_text(json.dumps(SCENE))


def check_ends():
    process, client, _ = start()
    process.stdin.close()
    assert process.wait(20) == 0  # at the end of its input
    process, client, _ = start()
    client.ask(do="get", wait="any")
    process.stdout.close()
    client.send(do="status")
    client.send(do="status")
    assert process.wait(20) == 0  # where nobody hears it
    for arguments, text in ((["--token-file", "x"], "goes with --port"), (["--port", "70000"], "--port")):
        got = subprocess.run([lamina, "serve", "scene.json", *arguments], capture_output=True, text=True, timeout=60)
        assert got.returncode == 2 and text in got.stderr, got
    got = subprocess.run([lamina, "serve", "none.json"], capture_output=True, text=True, timeout=60)
    assert got.returncode == 2 and "none.json" in got.stderr and not got.stdout, got


def connect(port):
    link = socket.create_connection(("127.0.0.1", port), timeout=60)
    return link, Client(link.sendall, link.makefile("rb").readline)


def check_socket():
    process, _, ready = start("--port", "0")
    port, token = ready["port"], ready["token"]
    assert len(token) == 32
    link, client = connect(port)
    client.send_bytes(b'{"token": "' + b"0" * 32 + b'"}\n')
    assert "token" in client.line()["error"] and not client.receive()
    link, client = connect(port)
    client.send_bytes(b'{"do": "status"}\n')
    assert "token" in client.line()["error"]
    # A client that is killed leaves room for the next, and the scene as it was.
    script = ("import json,socket,sys,time; s = socket.create_connection(('127.0.0.1', int(sys.argv[1])));"
              "s.sendall(json.dumps({'token': sys.argv[2]}).encode() + b'\\n');"
              "s.sendall(b'{\"do\": \"set\", \"values\": {\"film.width\": 22}}\\n{\"do\": \"get\", \"wait\": \"any\"}\\n');"
              "s.recv(10); print('sent', flush=True); time.sleep(100)")
    killed = subprocess.Popen([sys.executable, "-c", script, str(port), token], stdout=subprocess.PIPE)
    killed.stdout.readline()
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    link, client = connect(port)
    client.send_bytes(json.dumps({"token": token}).encode() + b"\n")
    assert client.line() == {"welcome": True}
    for _ in range(100):
        if client.ask(do="status")["change"] == 2:
            break
        time.sleep(0.1)
    assert client.ask(do="get", wait="any")["picture"]["width"] == 22
    # Nobody but this host is heard.
    listening = Path("/proc/net/tcp").read_text() if Path("/proc/net/tcp").exists() else ""
    if f":{port:04X} 00000000:0000 0A" in listening:
        assert f"0100007F:{port:04X} 00000000:0000 0A" in listening
    process.kill()
    assert process.wait(20) == -signal.SIGKILL
    assert not client.receive()
    Path("token").write_text("0123456789abcdef\n")
    process, _, ready = start("--port", "0", "--token-file", "token")
    assert "token" not in ready
    link, client = connect(ready["port"])
    client.send_bytes(b'{"token": "0123456789abcdef"}\n')
    assert client.line() == {"welcome": True}
    client.ask(do="quit")
    assert process.wait(20) == 0


def check_many_changes(count=int(os.environ.get("LAMINA_SERVE_CHANGES", "300"))):
    """No growth over many changes."""
    process, client, _ = start("--set", "film.width=8", "--set", "film.height=8")
    sizes = []

    def resident():
        with open(f"/proc/{process.pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20

    for i in range(count):
        client.ask(do="set", values={"materials.wall.diffuse": 0.2 + 0.5 * i / count, "camera.position": [0, 0, 9 + i / count]})
        if i % 10 == 0:
            client.ask(do="get", format="raw", wait="any")
        if i in (count // 5, count - 1):
            sizes.append(resident())
    print(f"{count} changes: {sizes[0]:.1f} MiB after a fifth, {sizes[-1]:.1f} MiB at the end")
    assert sizes[-1] < 1.2 * sizes[0] + 8, sizes
    client.ask(do="quit")
    assert process.wait(20) == 0


check_messages()
check_ends()
check_socket()
if Path("/proc/self/statm").exists():
    check_many_changes()
