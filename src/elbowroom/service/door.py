"""Who is let in: host, origin, token, a number used once, the time, and how often. It holds no clock."""

import hashlib
import hmac
import json
import re
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

NONCE = re.compile(r"[0-9A-Za-z]{16,64}")
AWAY_MS = 5000
"""A request's time is at most so far off the service's [ms]."""
REMEMBERED_S = 600.0
"""A nonce is remembered for so long [s], by a clock that never goes back."""
A_SECOND, OWN_A_SECOND = 200.0, 50.0
"""So many requests a second, and so many more with the right token: a flood locks nobody out who knows it."""
WRONG_TOKENS, WRONG_S = 10, 10.0
TOKEN_PATHS = ("/v1/reset", "/v1/hold")


class Refusal(Exception):
    """A request that is not let in.

    Args:
        status: of HTTP.
        why: one sentence.
    """

    def __init__(self, status: int, why: str) -> None:
        super().__init__(why)
        self.status, self.why = status, why


@dataclass(slots=True)
class Bucket:
    """Lets so many through a second, and as many at once.

    Args:
        a_second: how many.
    """

    a_second: float
    _left: float = field(init=False)
    _at_s: float | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self._left = self.a_second

    def take(self, now_s: float) -> bool:
        """Whether one more is let through.

        Args:
            now_s: the time [s].
        """
        went_s = 0.0 if self._at_s is None else max(now_s - self._at_s, 0.0)
        self._at_s = now_s
        self._left = min(self.a_second, self._left + went_s * self.a_second)
        if self._left < 1:
            return False
        self._left -= 1
        return True


@dataclass(frozen=True, slots=True)
class Now:
    """The time by both clocks.

    Args:
        steady_s: of one that never goes back [s].
        wall_ms: milliseconds since 1970.
    """

    steady_s: float
    wall_ms: int


@dataclass(slots=True, eq=False)
class Door:
    """What is remembered of requests.

    Args:
        token: that opens it.
        hosts: `Host` has to be one of these, exactly.
        origins: so has `Origin`, where there is one.
        began_ms: requests that were sent before are of an earlier run [ms since 1970].
    """

    token: str
    hosts: frozenset[str]
    origins: frozenset[str]
    began_ms: int
    _every: Bucket = field(default_factory=lambda: Bucket(A_SECOND), init=False)
    _own: Bucket = field(default_factory=lambda: Bucket(OWN_A_SECOND), init=False)
    _wrong_s: deque[float] = field(default_factory=lambda: deque(maxlen=WRONG_TOKENS), init=False)
    _seen: dict[str, float] = field(default_factory=dict, init=False)

    def let_in(self, path: str, headers: Mapping[str, str], now: Now, *, is_preflight: bool = False) -> None:
        """Lets a head in, before its body is read.

        Args:
            path: what is asked for.
            headers: by name, in small letters.
            now: the time.
            is_preflight: it only asks whether a page may ask; browsers send no token with that.

        Raises:
            Refusal: it is not let in.
        """
        given = self._given_token(headers)
        is_right = given is not None and _same(given, self.token)
        bucket = self._own if is_right else self._every
        if not bucket.take(now.steady_s):
            raise Refusal(429, "too many requests")
        if headers.get("host", "").lower() not in self.hosts:
            raise Refusal(403, "Host is not a name of this service")
        origin = headers.get("origin")
        if origin is not None and origin not in self.origins:
            raise Refusal(403, "Origin is not allowed here")
        if path in TOKEN_PATHS and not is_right and not is_preflight:
            self._wrong(now.steady_s)

    def shares_with(self, headers: Mapping[str, str]) -> str | None:
        """The origin whose page may read an answer, by its exact name; None: no page may.

        Args:
            headers: by name, in small letters.
        """
        origin = headers.get("origin")
        known = headers.get("host", "").lower() in self.hosts and origin in self.origins
        return origin if known else None

    def admitted(self, headers: Mapping[str, str], body: bytes, now: Now) -> int:
        """When a request with a token was sent, which was not asked before [ms since 1970].

        Args:
            headers: by name, in small letters.
            body: whole.
            now: the time.

        Raises:
            Refusal: it is not let in.
        """
        if headers.get("content-type", "").split(";")[0].strip().lower() != "application/json":
            raise Refusal(415, "the body has to be application/json")
        nonce, sent_ms = _read(body)
        if abs(now.wall_ms - sent_ms) > AWAY_MS or sent_ms < self.began_ms:
            raise Refusal(409, f"time_ms is more than {AWAY_MS} ms off, or from before this service began")
        self._forget(now.steady_s)
        if nonce in self._seen:
            raise Refusal(409, "nonce was used before")
        self._seen[nonce] = now.steady_s
        return sent_ms

    @staticmethod
    def _given_token(headers: Mapping[str, str]) -> str | None:
        scheme, _, token = headers.get("authorization", "").partition(" ")
        return token.strip() if scheme.lower() == "bearer" and token else None

    def _wrong(self, now_s: float) -> None:
        if len(self._wrong_s) == WRONG_TOKENS and now_s - self._wrong_s[0] < WRONG_S:
            raise Refusal(429, "too many wrong tokens")
        self._wrong_s.append(now_s)
        raise Refusal(401, "a token is needed: Authorization: Bearer ...")

    def _forget(self, now_s: float) -> None:
        for nonce, at_s in tuple(self._seen.items()):  # in the order in which they came
            if now_s - at_s <= REMEMBERED_S:
                return
            del self._seen[nonce]


def _same(given: str, token: str) -> bool:
    """Whether two tokens are the same, in a time that says nothing of where they differ, or how long they are."""
    one, other = (hashlib.sha256(each.encode("utf-8", "surrogatepass")).digest() for each in (given, token))
    return hmac.compare_digest(one, other)


def _read(body: bytes) -> tuple[str, int]:
    """Nonce and time of a body.

    Raises:
        Refusal: it is not of that form, and nothing else.
    """
    try:
        said: Any = json.loads(body)
    except (ValueError, RecursionError):
        raise Refusal(400, "the body is no JSON") from None
    if not isinstance(said, dict) or set(said) != {"nonce", "time_ms"}:
        raise Refusal(400, "the body has to hold nonce and time_ms, and nothing else")
    nonce, sent_ms = said["nonce"], said["time_ms"]
    if not isinstance(nonce, str) or NONCE.fullmatch(nonce) is None:
        raise Refusal(400, "nonce has to be 16 to 64 letters and digits")
    if not isinstance(sent_ms, int) or isinstance(sent_ms, bool):
        raise Refusal(400, "time_ms has to be a whole number of milliseconds since 1970")
    return nonce, sent_ms
