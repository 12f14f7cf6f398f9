"""The running service, attacked: nothing is let in, and whoever knows the token still gets through."""

import http.client
import json
import secrets
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from elbowroom.errors import InputError
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.serving import Serving
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.sensing import Snapshot
from elbowroom.service.token import made_token

pytest.importorskip("h11")
MOTIONS = (Motion("slide", 1, 0.1), Motion("slide", -1, 0.1))
PAGE = "http://127.0.0.1:8137"
"""A page that may ask."""
RULES = Rules(tuple(motion.name for motion in MOTIONS), 250_000_000, 20.0)


class Running:
    """A gate that judges each 20 ms, and its service."""

    def __init__(self, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.token = made_token(folder / "token")
        self.gate = Gate(folder / "gate", "test", RULES)
        self.gate.begin()
        self.serving = Serving(self.gate, self.port, folder / "token", (PAGE,))
        self.serving.start()
        self.passes = 0
        self.reached: list[str] = []
        self.failing = False
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._judge, daemon=True)
        self._thread.start()

    def _judge(self) -> None:
        sequence = 0
        while not self._ends.wait(0.02):
            sequence += 1
            verdicts = tuple(Verdict(m, Level.CLEAR, 0.9, "m", None, None, Cause.NONE) for m in MOTIONS)
            fault = "made to fail" if self.failing else None
            result = CycleResult(sequence, 0, None, verdicts, {"carve": 7.0}, 12.0, fault)
            self.passes += 1
            decision = self.gate.decide(result)
            if decision.answer is not None:
                self.reached.append(decision.answer)
            self.serving.show(Pass(Snapshot(()), result, 0.0, decision))

    def end(self) -> None:
        self._ends.set()
        self._thread.join()
        self.serving.end()
        self.gate.end()

    def ask(self, method: str, path: str, body: bytes | None = None, **headers: str) -> tuple[int, Any]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        given = {"Host": f"127.0.0.1:{self.port}"} | {k.replace("_", "-"): v for k, v in headers.items()}
        connection.request(method, path, body, given)
        answer = connection.getresponse()
        data = answer.read().decode()
        connection.close()
        is_json = answer.headers["content-type"] == "application/json"
        return answer.status, json.loads(data) if is_json else data

    def headers(self, method: str, path: str, **headers: str) -> Any:
        """Of an answer, with its status."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        given = {"Host": f"127.0.0.1:{self.port}"} | {k.replace("_", "-"): v for k, v in headers.items()}
        connection.request(method, path, None, given)
        answer = connection.getresponse()
        answer.read()
        connection.close()
        answer.headers.status = answer.status
        return answer.headers

    def control(self, what: str, body: bytes | None = None, **headers: str) -> tuple[int, Any]:
        given = {"Authorization": f"Bearer {self.token}", "Content_Type": "application/json"} | headers
        return self.ask("POST", f"/v1/{what}", once() if body is None else body, **given)

    def raw(self, *parts: bytes, every_s: float = 0.0, most_s: float = 6.0) -> bytes:
        with socket.create_connection(("127.0.0.1", self.port), timeout=most_s) as sent:
            try:
                for part in parts:
                    sent.sendall(part)
                    time.sleep(every_s)
                answer = b""
                while data := sent.recv(65536):
                    answer += data
            except (ConnectionError, TimeoutError):
                return b""
        return answer


def once(nonce: str | None = None, off_ms: int = 0) -> bytes:
    told = {"nonce": nonce or secrets.token_hex(16), "time_ms": time.time_ns() // 1_000_000 + off_ms}
    return json.dumps(told).encode()


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    with tempfile.TemporaryDirectory() as folder:  # a socket's path has to be short
        run = Running(Path(folder))
        until_s = time.monotonic() + 5
        while run.ask("GET", "/health/ready")[0] != 200 and time.monotonic() < until_s:
            time.sleep(0.02)
        yield run
        run.end()


def test_a_reset_and_a_held_signal_reach_the_gate_and_are_in_its_decisions(running: Running) -> None:
    status, said = running.control("reset")
    assert status == 200 and said["answer"] and set(said["gate"]) >= {"phase", "level", "latched"}
    assert running.reached and running.reached[-1] == said["answer"]
    assert running.control("hold") == (200, {"done": True})
    time.sleep(0.6)  # what was sent before the service began is refused
    # a signal that took longer than it counts is none
    assert running.control("hold", once(off_ms=-400)) == (200, {"done": False})


def test_a_reset_is_refused_while_a_cause_is_there_and_moves_nothing(running: Running) -> None:
    running.failing = True
    time.sleep(0.1)
    status, said = running.control("reset")
    assert status == 200 and said["done"] is False and "refused" in said["answer"]
    running.failing = False
    time.sleep(0.1)
    assert running.control("reset")[1]["done"] is True


def test_what_is_asked_without_a_token_is_answered_and_does_not_reach_the_gate(running: Running) -> None:
    before = len(running.reached)
    assert running.ask("GET", "/health/live") == (200, {"ok": True})
    assert running.ask("GET", "/v1/status")[1]["motions"].keys() == set(RULES.motions)
    status, described = running.ask("GET", "/openapi.json")
    assert status == 200 and described["openapi"].startswith("3.1")
    assert len(running.reached) == before


def test_metrics_are_what_prometheus_reads(running: Running) -> None:
    parser = pytest.importorskip("prometheus_client.parser")
    families = {
        one.name: one for one in parser.text_string_to_metric_families(running.ask("GET", "/metrics")[1])
    }
    assert families["elbowroom_passes"].samples[0].value > 0
    assert {sample.labels["motion"] for sample in families["elbowroom_motion_speed_ratio"].samples} == set(
        RULES.motions
    )
    assert families["elbowroom_image_age_seconds"].samples[0].value == pytest.approx(0.012)
    assert any(sample.name.endswith("_bucket") for sample in families["elbowroom_cycle_seconds"].samples)


def test_a_wrong_token_a_foreign_origin_and_a_foreign_host_are_refused(running: Running) -> None:
    before = len(running.reached)
    assert running.control("reset", Authorization="Bearer " + "0" * 64)[0] == 401
    assert running.control("reset", Authorization="")[0] == 401
    for origin in (
        "http://evil.example",
        "null",
        f"http://127.0.0.1:{running.port}.evil.example",
        "http://127.0.0.1",
    ):
        assert running.control("reset", Origin=origin)[0] == 403
    for host in (
        "evil.example",
        f"evil.example:{running.port}",
        "127.0.0.1",
        f"127.0.0.1:{running.port}@evil",
    ):
        assert running.control("reset", Host=host)[0] == 403  # DNS rebinding
        assert running.ask("GET", "/v1/status", Host=host)[0] == 403
    assert len(running.reached) == before
    status, _ = running.control("reset", Origin=f"http://127.0.0.1:{running.port}")
    assert status == 200


def test_an_allowed_page_may_ask_and_read_and_no_other_page_may(running: Running) -> None:
    asks = {"Origin": PAGE, "Access_Control_Request_Method": "POST"}
    for path in ("/v1/reset", "/v1/hold", "/health/live"):
        headers = running.headers("OPTIONS", path, **asks)
        assert headers["access-control-allow-origin"] == PAGE and headers["vary"] == "origin"
        assert headers["access-control-allow-headers"] == "authorization, content-type"
    assert running.headers("OPTIONS", "/v1/other", **asks).status == 404
    before = len(running.reached)
    for origin in (
        "http://evil.example",
        "null",
        f"{PAGE}.evil.example",
        f"{PAGE}0",
        PAGE.replace("127.0.0.1", "localhost"),
        PAGE.replace("http", "https"),
        f"{PAGE}/",
    ):
        for method in ("OPTIONS", "POST"):
            headers = running.headers(method, "/v1/reset", Origin=origin)
            assert headers.status == 403 and "access-control-allow-origin" not in headers
    assert running.headers("OPTIONS", "/v1/reset").status == 405  # nobody may ask for nobody
    assert "access-control-allow-origin" not in running.headers("GET", "/health/live")
    assert "access-control-allow-origin" not in running.headers(
        "GET", "/health/live", Origin=PAGE, Host="evil.example"
    )
    refused = running.headers("POST", "/v1/reset", Origin=PAGE)  # the page may read why
    assert refused.status == 401 and refused["access-control-allow-origin"] == PAGE
    assert "access-control-allow-credentials" not in refused
    assert len(running.reached) == before
    assert running.control("reset", Origin=PAGE)[0] == 200


def test_a_request_that_was_heard_is_refused_when_it_comes_again(running: Running) -> None:
    body = once()
    assert running.control("reset", body)[0] == 200
    before = len(running.reached)
    assert [running.control("reset", body)[0] for _ in range(3)] == [409] * 3
    assert running.control("reset", once(off_ms=-6000))[0] == 409
    assert len(running.reached) == before


def test_what_is_too_large_or_no_http_is_refused(running: Running) -> None:
    assert running.control("reset", b" " * 3000)[0] == 413
    head = f"POST /v1/reset HTTP/1.1\r\nHost: 127.0.0.1:{running.port}\r\n".encode()
    assert b" 431 " in running.raw(head + b"X: " + b"a" * 20_000 + b"\r\n\r\n")[:20]
    for said in (
        b"\x16\x03\x01\x02\x00",
        b"GET\r\n\r\n",
        head + head,
        head + b"Host: evil\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
    ):
        answer = running.raw(said + b"\r\n\r\n")
        assert answer == b"" or answer.split(b" ")[1] in (b"400", b"403"), said
    both = b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\nPOST /v1/reset HTTP/1.1\r\n\r\n"
    assert running.raw(head + both).count(b"HTTP/1.1") == 1  # nothing is smuggled behind a request


def test_who_sends_slowly_is_let_go_and_holds_nobody_up(running: Running) -> None:
    slow = [
        threading.Thread(
            target=running.raw, args=(*[b"GET / HTTP/1.1\r\n"], *[b"X: y\r\n"] * 40), kwargs={"every_s": 0.1}
        )
        for _ in range(40)
    ]
    for thread in slow:
        thread.start()
    begun_s = time.monotonic()
    assert running.control("reset")[0] == 200 and time.monotonic() - begun_s < 1.5
    answer = running.raw(b"GET / HTTP/1.1\r\n")
    assert b" 408 " in answer[:20] and time.monotonic() - begun_s < 5
    for thread in slow:
        thread.join()


def test_a_websocket_from_another_site_gets_nothing(running: Running) -> None:
    client = pytest.importorskip("websockets.sync.client")
    exceptions = pytest.importorskip("websockets.exceptions")
    for origin in ("http://evil.example", None):
        with pytest.raises(exceptions.InvalidStatus) as caught:
            client.connect(f"ws://127.0.0.1:{running.port}/v1/hold", origin=origin, open_timeout=5)
        assert caught.value.response.status_code in (401, 403)


def test_a_thousand_requests_a_second_let_nothing_in_and_delay_no_pass(running: Running) -> None:
    before, until_s, seen = len(running.reached), time.monotonic() + 1.0, set()
    passes = running.passes
    head = f"POST /v1/reset HTTP/1.1\r\nHost: 127.0.0.1:{running.port}\r\nContent-Length: 0\r\n\r\n".encode()
    sent = 0
    while time.monotonic() < until_s:
        seen.add(running.raw(head)[9:12])
        sent += 1
    assert seen <= {b"401", b"429", b"503", b""} and len(running.reached) == before and sent > 50
    assert (
        running.passes - passes > 5
    )  # the gate waits for nobody; by how much passes are later is measured apart
    time.sleep(0.3)
    assert running.control("reset")[0] == 200


def test_what_its_own_description_allows_breaks_nothing(running: Running, tmp_path: Path) -> None:
    schemathesis = pytest.importorskip("schemathesis")
    from hypothesis import HealthCheck, given, settings

    schema = schemathesis.openapi.from_url(
        f"http://127.0.0.1:{running.port}/openapi.json", headers={"Host": f"127.0.0.1:{running.port}"}
    )
    tried = []
    for operation in schema.get_all_operations():

        @settings(max_examples=6, database=None, suppress_health_check=list(HealthCheck))
        @given(case=operation.ok().as_strategy())
        def attack(case) -> None:
            time.sleep(0.01)
            answer = case.call(headers={"Host": f"127.0.0.1:{running.port}"})
            assert answer.status_code < 500 or answer.status_code == 503
            tried.append(answer.status_code)

        attack()
    assert len(tried) >= 14 and 200 in tried
    assert running.control("reset")[0] == 200


def test_a_service_that_cannot_begin_says_why(running: Running, tmp_path: Path) -> None:
    token = tmp_path / "token"
    made_token(token)
    with pytest.raises(InputError, match="in use"):
        Serving(running.gate, running.port, token).start()
    token.chmod(0o644)
    with pytest.raises(InputError, match="chmod 600"):
        Serving(running.gate, running.port + 1, token).start()


def test_the_process_is_small_and_ends_with_the_monitor(tmp_path: Path) -> None:
    words = "import sys, elbowroom.service.process; print('numpy' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", words], capture_output=True, text=True).stdout == "False\n"
    with tempfile.TemporaryDirectory() as folder:
        run = Running(Path(folder))
        process = run.serving._process
        run.end()
        assert process is not None and process.returncode == 0
        with pytest.raises(OSError):
            run.ask("GET", "/health/live")


def test_a_latched_fault_is_among_the_numbers() -> None:
    from elbowroom.service.metrics import Metrics

    metrics = Metrics()
    assert "elbowroom_level" not in metrics.text(0.0)
    fault = Fault(Reason.CAMERA_GAPS, "cam1", "x")
    gate = {"level": "stop", "speed": 0.0, "motions": {'a"b': {"speed": 0.0}}, "latched": [fault.sentence]}
    told = {
        "cycle_ms": 30.0,
        "oldest_age_ms": None,
        "skew_ms": None,
        "causes": ["unseen"],
        "sick": ["gaps"],
        "gate": gate,
    }
    metrics.heard(told, 1.0)
    text = metrics.text(3.0)
    assert 'elbowroom_motion_speed_ratio{motion="a\\"b"} 0.0' in text and "elbowroom_latched 1.0" in text
    assert 'elbowroom_sick_sources{cause="gaps"} 1' in text and "elbowroom_pass_age_seconds 2.0" in text
    assert 'elbowroom_cycle_seconds_bucket{le="0.03"} 1' in text and 'le="0.02"} 0' in text
