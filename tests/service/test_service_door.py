"""Who is let in: a law for each thing that is looked at. Tokens are files of their owner alone."""

import json
import os
import string
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.service.door import (
    A_SECOND,
    AWAY_MS,
    OWN_A_SECOND,
    REMEMBERED_S,
    WRONG_S,
    WRONG_TOKENS,
    Bucket,
    Door,
    Now,
    Refusal,
)
from elbowroom.service.token import made_token, read_token

TOKEN = "a1" * 32
HOSTS = ("127.0.0.1:8088", "localhost:8088")
T_MS = 1_764_450_000_000
RIGHT = {"host": HOSTS[0], "authorization": f"Bearer {TOKEN}", "content-type": "application/json"}


def door() -> Door:
    return Door(TOKEN, frozenset(HOSTS), frozenset(f"http://{host}" for host in HOSTS), T_MS - 60_000)


def body(nonce: object = "a" * 16, time_ms: object = T_MS, **more: object) -> bytes:
    return json.dumps({"nonce": nonce, "time_ms": time_ms, **more}).encode()


def refused(call, *args) -> int:
    with pytest.raises(Refusal) as caught:
        call(*args)
    return caught.value.status


@given(st.text(max_size=40))
def test_no_other_host_no_other_origin_no_other_token_is_let_in(text: str) -> None:
    now = Now(0.0, T_MS)
    door().let_in("/v1/reset", RIGHT, now)
    if text.lower() not in HOSTS:
        assert refused(door().let_in, "/v1/reset", RIGHT | {"host": text}, now) == 403
    assert refused(door().let_in, "/v1/reset", RIGHT | {"origin": text}, now) == 403
    door().let_in("/v1/reset", RIGHT | {"origin": f"http://{HOSTS[1]}"}, now)
    for scheme in ("Bearer ", "Basic ", ""):
        assert refused(door().let_in, "/v1/hold", RIGHT | {"authorization": scheme + text}, now) == 401


@pytest.mark.parametrize(
    "host",
    [
        "",
        "127.0.0.1",
        "127.0.0.1:8089",
        "evil.example:8088",
        "127.0.0.1:8088.evil.example",
        "localhost:8088 ",
        "[::1]:1",
    ],
)
def test_a_host_is_an_exact_name_and_port(host: str) -> None:
    assert refused(door().let_in, "/health/live", RIGHT | {"host": host}, Now(0.0, T_MS)) == 403


def test_nothing_is_asked_of_a_token_where_none_is_needed() -> None:
    door().let_in("/metrics", {"host": HOSTS[0]}, Now(0.0, T_MS))


@given(
    st.text(string.ascii_letters + string.digits, min_size=16, max_size=64), st.integers(-AWAY_MS, AWAY_MS)
)
def test_a_request_is_let_in_once_and_near_its_time_alone(nonce: str, off_ms: int) -> None:
    one = door()
    assert one.admitted(RIGHT, body(nonce, T_MS + off_ms), Now(5.0, T_MS)) == T_MS + off_ms
    assert refused(one.admitted, RIGHT, body(nonce, T_MS + off_ms), Now(5.0, T_MS)) == 409
    assert refused(one.admitted, RIGHT, body(nonce, T_MS + off_ms), Now(REMEMBERED_S, T_MS)) == 409
    for away in (AWAY_MS + 1, -AWAY_MS - 1):
        assert refused(door().admitted, RIGHT, body(nonce, T_MS + away), Now(5.0, T_MS)) == 409
    young = Door(TOKEN, frozenset(HOSTS), frozenset(), T_MS + 1)  # it began after that was sent
    assert refused(young.admitted, RIGHT, body(nonce, T_MS), Now(5.0, T_MS)) == 409


@pytest.mark.parametrize(
    "said",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"[" * 5000,
        body(time_ms=True),
        body(time_ms=1.5),
        body(time_ms="1"),
        body(nonce=7),
    ]
    + [body(nonce=nonce) for nonce in ("short", "a" * 65, "a" * 15 + "!", "a" * 16 + "\n")]
    + [body(speed=1), b'{"nonce": "aaaaaaaaaaaaaaaa"}', b'{"nonce": NaN, "time_ms": NaN}'],
)
def test_a_body_of_another_form_is_refused(said: bytes) -> None:
    assert refused(door().admitted, RIGHT, said, Now(0.0, T_MS)) == 400


@pytest.mark.parametrize(
    "kind", ["", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data"]
)
def test_what_a_form_of_another_site_can_send_is_refused(kind: str) -> None:
    assert refused(door().admitted, RIGHT | {"content-type": kind}, body(), Now(0.0, T_MS)) == 415


def test_a_flood_locks_nobody_out_who_knows_the_token() -> None:
    one, now = door(), Now(0.0, T_MS)
    stranger = {"host": HOSTS[0]}
    for _ in range(int(A_SECOND)):
        one.let_in("/health/live", stranger, now)
    assert refused(one.let_in, "/health/live", stranger, now) == 429
    for _ in range(int(OWN_A_SECOND)):
        one.let_in("/v1/reset", RIGHT, now)
    assert refused(one.let_in, "/v1/reset", RIGHT, now) == 429
    one.let_in("/v1/reset", RIGHT, Now(0.1, T_MS))


def test_guessing_is_slow() -> None:
    one, wrong = door(), RIGHT | {"authorization": "Bearer " + "b" * 64}
    said = [refused(one.let_in, "/v1/reset", wrong, Now(0.01 * n, T_MS)) for n in range(WRONG_TOKENS + 5)]
    assert said == [401] * WRONG_TOKENS + [429] * 5
    assert refused(one.let_in, "/v1/reset", wrong, Now(WRONG_S + 1, T_MS)) == 401
    one.let_in("/v1/reset", RIGHT, Now(0.2, T_MS))


@given(st.lists(st.floats(0, 0.3), max_size=80))
def test_a_bucket_lets_through_no_more_than_it_says(steps: list[float]) -> None:
    bucket, now_s, let = Bucket(10.0), 0.0, 0
    for step in steps:
        now_s += step
        let += bucket.take(now_s)
    assert let <= 10 + 10 * now_s + 1e-6


def test_a_token_is_a_file_of_its_owner_alone(tmp_path: Path) -> None:
    path = tmp_path / "token"
    token = made_token(path)
    assert read_token(path) == token and len(token) == 64 and path.stat().st_mode & 0o777 == 0o600
    with pytest.raises(InputError, match="there already"):
        made_token(path)
    for mode in (0o644, 0o660, 0o604, 0o620):
        path.chmod(mode)
        with pytest.raises(InputError, match="chmod 600"):
            read_token(path)
    path.chmod(0o600)
    link = tmp_path / "link"
    link.symlink_to(path)
    for other in (link, tmp_path / "none", tmp_path):
        with pytest.raises(InputError):
            read_token(other)
    os.mkfifo(tmp_path / "pipe", 0o600)
    with pytest.raises(InputError, match="no file"):
        read_token(tmp_path / "pipe")
    for content in ("", "short", "ä" * 40, "x" * 5000, "a b" * 20):
        path.write_text(content, encoding="utf-8")
        with pytest.raises(InputError, match="no token"):
            read_token(path)
